// A host of Sparkplug B for tests: the payloads are read and written by Eclipse Tahu's own library.
//
// Arguments, printed lines and obeyed lines are those of ../python/sparkplug_host.py. The library wants a
// type with each metric; Sparkplug 3.0 has types in births alone (tck-id-payloads-metric-datatype-not-req),
// so data get them from the birth before they are read.

const mqtt = require("mqtt");
const { Payload } = require("sparkplug-payload/lib/sparkplugPayloadProto").org.eclipse.tahu.protobuf;
const { decodePayload, encodePayload } = require("sparkplug-payload").get("spBv1.0");

const [port, group, node] = process.argv.slice(2);
const births = {};
const devices = {};
let last = null;

/** The birth of a metric. */
function born(own, { name, alias }) {
  return births[own]?.find((b) => (name ? b.name === name : String(b.alias) === String(alias)));
}

/** A payload whose metrics have the types of their births. */
function typed(own, bytes) {
  const payload = Payload.decode(bytes);
  for (const metric of payload.metrics) metric.datatype ||= born(own, metric)?.datatype;
  return Payload.encode(payload).finish();
}

/** A value as Python prints it. */
function shown({ type, value }) {
  if (value === null || value === undefined) return "None";
  if (typeof value === "boolean") return value ? "True" : "False";
  const real = type === "Float" || type === "Double";
  return real && Number.isInteger(value) ? value.toFixed(1) : String(value);
}

function onMessage(topic, bytes, packet) {
  const [, , kind, , ...device] = topic.split("/");
  if (!/^[ND](BIRTH|DATA|DEATH)$/.test(kind)) return;
  const own = kind[0];
  if (kind.endsWith("BIRTH")) {
    births[own] = Payload.decode(bytes).metrics;
    devices[own] = device;
  }
  const payload = decodePayload(typed(own, bytes));
  const seq = kind === "NDEATH" ? "-" : Number(payload.seq);
  if (seq !== "-") {
    if (seq !== (kind === "NBIRTH" ? 0 : (last + 1) % 256)) console.log("GAP");
    last = seq;
  }
  const values = (payload.metrics ?? []).map((metric) => `${born(own, metric)?.name ?? metric.name}=${shown(metric)}`);
  console.log([kind, packet.qos, Number(packet.retain), seq, ...values].join(" "));
}

function command(client, [how, kind, words, type, text]) {
  const name = words.replace(/_/g, " ");
  const { alias } = born(kind[0], { name });
  const value = type === "BOOLEAN" ? text === "True" : Number(text);
  const timestamp = Date.now();
  const metric = { ...(how === "alias" ? { alias } : { name }), timestamp, type, value };
  const topic = ["spBv1.0", group, kind, node, ...devices[kind[0]]].join("/");
  client.publish(topic, Buffer.from(encodePayload({ timestamp, metrics: [metric] })), { qos: 0 });
}

const client = mqtt.connect(`mqtt://127.0.0.1:${port}`, { reconnectPeriod: 0 });
client.on("message", onMessage);
client.on("error", () => process.exit(1));
client.on("close", () => process.exit(0));
client.on("connect", () =>
  client.subscribe(`spBv1.0/${group}/#`, { qos: 1 }, () => console.log("ready")),
);
const lines = require("node:readline").createInterface({ input: process.stdin });
lines.on("line", (line) => command(client, line.trim().split(" ")));
lines.on("close", () => process.exit(0));
