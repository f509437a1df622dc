"""An OPC UA client of asyncua for tests.

Arguments: the address; then `user=NAME:PASSWORD`, and `certificate=FILE` with `key=FILE` for a
connection that is signed and encrypted. It prints `connected`, or `refused` with the name of the
status, and then obeys lines on the standard input: `read NODE`, `write NODE TYPE VALUE`, `about NODE`,
`browse`, `watch NODE`, which lets it print each change, and `many COUNT`, which reads so many nodes
`w0`, `w1` … in one request and says how long it took, and `subscribe COUNT`, which makes a subscription
for each of so many of them and says how long it took until each has sent something. Nodes are in the namespace `urn:g7:chart`.
"""

import asyncio
import json
import logging
import sys
import threading
import time

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


class Count:
    """Keeps in mind which nodes have sent something."""

    def __init__(self):
        self.seen = set()

    def datachange_notification(self, node, _value, _data):
        self.seen.add(node.nodeid.Identifier)


def shown(value):
    plain = json.dumps(value.Value.Value if value.Value else None)
    return f"{plain} {value.StatusCode.name}"


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
        for _ in range(10):
            begin = time.monotonic()
            values = await client.read_values(nodes)
            times.append(time.monotonic() - begin)
        return f"{len(values)} {min(times) * 1e3:.1f} ms"
    if verb == "subscribe":
        count = Count()
        begin = time.monotonic()
        for k in range(int(words[0])):
            subscription = await client.create_subscription(100, count)
            await subscription.subscribe_data_change(node(f"w{k}"))
        while len(count.seen) < int(words[0]):
            await asyncio.sleep(0.01)
        return f"{len(count.seen)} {time.monotonic() - begin:.2f} s"
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
    loop, lines = asyncio.get_running_loop(), asyncio.Queue()

    def read():
        for line in sys.stdin:
            loop.call_soon_threadsafe(lines.put_nowait, line.split())
        loop.call_soon_threadsafe(lines.put_nowait, None)

    threading.Thread(target=read, daemon=True).start()
    while words := await lines.get():
        try:
            answer = await obey(client, index, words)
        except Exception as error:
            answer = f"refused {name_of(error)}"
        print(answer, flush=True)
    await client.disconnect()


asyncio.run(main(sys.argv[1:]))
