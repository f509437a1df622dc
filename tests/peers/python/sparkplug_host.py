"""A host of Sparkplug B for tests: paho-mqtt with the decoder of pysparkplug.

Arguments: the port of a broker on this machine, the group and the node. It prints `ready`, then each
message of the node as `TYPE QOS RETAINED SEQ NAME=VALUE...`, and `GAP` before one whose number does not
follow the last one. It obeys lines on the standard input: `name NCMD|DCMD NAME TYPE VALUE` writes a metric
by its name, `alias ...` by the alias of the last birth; the types are those of pysparkplug, and `_` stands
for a blank in a name.
"""

import sys

import paho.mqtt.client
import pysparkplug
from pysparkplug import DataType, Metric

TYPES = {
    "NBIRTH": pysparkplug.NBirth,
    "DBIRTH": pysparkplug.DBirth,
    "NDATA": pysparkplug.NData,
    "DDATA": pysparkplug.DData,
    "NDEATH": pysparkplug.NDeath,
}
port, group, node = int(sys.argv[1]), sys.argv[2], sys.argv[3]
births, devices, last = {}, {}, [None]


def on_message(_client, _data, message):
    kind = message.topic.split("/")[2]
    if kind not in TYPES:
        return
    own = kind[0]
    payload = TYPES[kind].decode(message.payload, birth=births.get(own))
    if kind.endswith("BIRTH"):
        births[own] = payload
        devices[own] = message.topic.split("/")[4:]
    metrics = [payload.bd_seq_metric] if kind == "NDEATH" else payload.metrics
    seq = "-" if kind == "NDEATH" else payload.seq
    if seq != "-":
        follows = 0 if kind == "NBIRTH" else (last[0] + 1) % 256
        if seq != follows:
            print("GAP", flush=True)
        last[0] = seq
    values = [f"{metric.name}={metric.value}" for metric in metrics]
    print(kind, message.qos, int(message.retain), seq, *values, flush=True)


def command(client, how, kind, name, datatype, value):
    # A name has no blanks on a line.
    name = name.replace("_", " ")
    birth = births[kind[0]]
    found = next(metric for metric in birth.metrics if metric.name == name)
    datatype = DataType[datatype]
    value = {"True": True, "False": False}.get(value) if value in ("True", "False") else float(value)
    if datatype not in (DataType.FLOAT, DataType.DOUBLE, DataType.BOOLEAN):
        value = int(value)
    now = pysparkplug.get_current_timestamp()
    by_alias = how == "alias"
    metric = Metric(
        timestamp=now,
        name=None if by_alias else name,
        datatype=datatype,
        value=value,
        alias=found.alias if by_alias else None,
    )
    of = pysparkplug.NCmd if kind == "NCMD" else pysparkplug.DCmd
    topic = "/".join(["spBv1.0", group, kind, node, *devices[kind[0]]])
    client.publish(topic, of(timestamp=now, metrics=(metric,)).encode(include_dtypes=True), qos=0)


def main():
    client = paho.mqtt.client.Client()
    client.on_message = on_message
    client.on_subscribe = lambda *_: print("ready", flush=True)
    client.on_connect = lambda *_: client.subscribe(f"spBv1.0/{group}/#", qos=1)
    client.connect("127.0.0.1", port)
    client.loop_start()
    for line in sys.stdin:
        command(client, *line.split())


main()
