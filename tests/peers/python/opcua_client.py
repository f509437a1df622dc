"""An OPC UA client of asyncua for tests.

Arguments: the address; then `user=NAME:PASSWORD`, and `certificate=FILE` with `key=FILE` for a
connection that is signed and encrypted. It prints `connected`, or `refused` with the name of the
status, and then obeys lines on the standard input: `read NODE`, `write NODE TYPE VALUE`, `about NODE`,
`browse`, `watch NODE`, which lets it print each change, and `many COUNT`, which reads so many nodes
`w0`, `w1` … in one request and says how long it took, and `latency COUNT TIMES`, which makes a subscription
for each of `q0`, `q1` …, turns `go` so often and says how long the changes took. Nodes are in the namespace `urn:g7:chart`.
"""

import asyncio
import json
import logging
import random
import sys
import time

from lines import lines
from asyncua import Client, ua
from asyncua.crypto.security_policies import SecurityPolicyBasic256Sha256


def name_of(error):
    code = getattr(error, "code", None)
    if code is None:
        return type(error).__name__
    return ua.status_codes.get_name_and_doc(code)[0]


class Watch:
    """Prints what comes."""

    def datachange_notification(self, node, _value, data):
        value = data.monitored_item.Value
        print(f"change {node.nodeid.Identifier} {shown(value)}", flush=True)


class Arrivals:
    """Keeps in mind when nodes have sent the value that is waited for."""

    def __init__(self):
        self.wanted, self.at = None, {}

    def datachange_notification(self, node, value, _data):
        if value == self.wanted:
            self.at.setdefault(node.nodeid.Identifier, time.monotonic())


def shown(value):
    plain = json.dumps(value.Value.Value if value.Value else None)
    return f"{plain} {value.StatusCode.name}"


async def latency(client, node, count, times):
    """Turns `go` on and off so often, and returns how long the changes of `q0` … took to come."""
    arrivals, took = Arrivals(), []
    for k in range(count):
        subscription = await client.create_subscription(50, arrivals)
        await subscription.subscribe_data_change(node(f"q{k}"))
    for turn in range(times):
        # The changes fall anywhere between two messages.
        await asyncio.sleep(0.15 + 0.05 * random.random())
        arrivals.at, arrivals.wanted = {}, turn % 2 == 0
        begin = time.monotonic()
        await node("go").write_value(ua.DataValue(ua.Variant(turn % 2 == 0, ua.VariantType.Boolean)))
        while len(arrivals.at) < count:
            if time.monotonic() - begin > 20:
                return f"only {len(arrivals.at)} of {count} came"
            await asyncio.sleep(0.005)
        took += [at - begin for at in arrivals.at.values()]
    took.sort()
    half, most, last = took[len(took) // 2], took[len(took) * 99 // 100], took[-1]
    return f"{len(took)} changes, half {half * 1e3:.0f} ms, 99 % {most * 1e3:.0f} ms, most {last * 1e3:.0f} ms"


async def connect(address, options):
    options = dict(option.split("=", 1) for option in options)
    client = Client(address, timeout=10)
    client.application_uri = "urn:g7:peer"
    if "certificate" in options:
        await client.set_security(
            SecurityPolicyBasic256Sha256,
            options["certificate"],
            options["key"],
            server_certificate=options.get("server"),
            mode=ua.MessageSecurityMode.SignAndEncrypt,
        )
    if "user" in options:
        user, password = options["user"].split(":", 1)
        client.set_user(user)
        client.set_password(password)
    await client.connect()
    return client


async def obey(client, index, words):
    def node(name):
        return client.get_node(ua.NodeId(name, index))

    verb, *words = words
    if verb == "read":
        return shown(await node(words[0]).read_data_value(raise_on_bad_status=False))
    if verb == "write":
        kind = getattr(ua.VariantType, words[1])
        await node(words[0]).write_value(ua.DataValue(ua.Variant(json.loads(words[2]), kind)))
        return "ok"
    if verb == "about":
        kind = await node(words[0]).read_data_type()
        text = (await node(words[0]).read_description()).Text or "-"
        parts = [ua.ObjectIdNames.get(kind.Identifier, kind.Identifier), text]
        for child in await node(words[0]).get_properties():
            parts.append((await child.read_value()).DisplayName.Text)
        return " ".join(parts)
    if verb == "browse":
        top = await client.nodes.objects.get_child([f"{index}:Chart"])
        found = []
        for folder in await top.get_children():
            name = (await folder.read_browse_name()).Name
            nodes = [child.nodeid.Identifier for child in await folder.get_children()]
            found.append(f"{name}: {', '.join(sorted(nodes))}")
        return "; ".join(sorted(found))
    if verb == "watch":
        subscription = await client.create_subscription(100, Watch())
        await subscription.subscribe_data_change(node(words[0]))
        return "ok"
    if verb == "many":
        nodes = [node(f"w{k}") for k in range(int(words[0]))]
        values = await client.read_values(nodes)
        times = []
        for _ in range(50):
            begin = time.monotonic()
            values = await client.read_values(nodes)
            times.append(time.monotonic() - begin)
        times.sort()
        return f"{len(values)} {times[0] * 1e3:.1f} {times[len(times) // 2] * 1e3:.1f}"
    if verb == "latency":
        return await latency(client, node, int(words[0]), int(words[1]))
    return "no such command"


async def main(arguments):
    logging.disable(logging.CRITICAL)
    try:
        client = await connect(arguments[0], arguments[1:])
    except Exception as error:
        print(f"refused {name_of(error)}", flush=True)
        return
    index = await client.get_namespace_index("urn:g7:chart")
    print("connected", flush=True)
    async for words in lines():
        try:
            answer = await obey(client, index, words)
        except Exception as error:
            answer = f"refused {name_of(error)}"
        print(answer, flush=True)
    await client.disconnect()


asyncio.run(main(sys.argv[1:]))
