"""An OPC UA server of asyncua for tests.

Arguments: the port, 0 for a free one; then `users`, `many` for 1000 nodes `w0` … of the namespace `urn:g7:chart`, and `certificate=FILE` with `key=FILE` for
connections that are signed and encrypted alone. It prints its port, then obeys lines on the
standard input: `set NODE VALUE` with a value of JSON and, behind it, the name of a status;
`get NODE`; `stall SECONDS`, in which it does nothing at all. The nodes are in the namespace
`urn:g7:peer`, with the types of `NODES`. With `users`, anna has the password `secret`.
"""

import asyncio
import json
import logging
import sys
import time

from lines import lines
from asyncua import Server, ua
from asyncua.crypto.permission_rules import User, UserRole

NAMESPACE = "urn:g7:peer"
NODES = {
    "Go": (False, ua.VariantType.Boolean),
    "Level": (0.0, ua.VariantType.Float),
    "Count": (0, ua.VariantType.Int16),
    "Text": ("none", ua.VariantType.String),
    "List": ([1, 2], ua.VariantType.Int32),
    "Valve": (False, ua.VariantType.Boolean),
    "Speed": (0, ua.VariantType.Int32),
    "Small": (0, ua.VariantType.Byte),
    "Flow": (0.0, ua.VariantType.Double),
    "Fixed": (False, ua.VariantType.Boolean),
}
FIXED = ["Fixed", "Text", "List"]


class Users:
    """Lets anna in."""

    def get_user(self, _server, username=None, password=None, certificate=None):
        if username == "anna" and password == "secret":
            return User(role=UserRole.Admin)
        return None


async def start(port, options):
    server = Server(user_manager=Users()) if "users" in options else Server()
    await server.init()
    server.set_endpoint(f"opc.tcp://127.0.0.1:{port}/peer")
    # The name that its certificate has.
    await server.set_application_uri(NAMESPACE)
    files = dict(option.split("=", 1) for option in options if "=" in option)
    if files:
        server.set_security_policy([ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt])
        await server.load_certificate(files["certificate"])
        await server.load_private_key(files["key"])
    else:
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
    index = await server.register_namespace(NAMESPACE)
    top = await server.nodes.objects.add_object(index, "Peer")
    nodes = {}
    for name, (value, kind) in NODES.items():
        node = await top.add_variable(ua.NodeId(name, index), name, value, kind)
        if name not in FIXED:
            await node.set_writable()
        nodes[name] = node
    # Numbers, a GUID and bytes name the same value as `Count` does.
    for identifier in [7, ua.uuid.UUID("72962B91-FA75-4AE6-8D28-B404DC7DAF63"), b"seven"]:
        await top.add_variable(ua.NodeId(identifier, index), "Seven", 7, ua.VariantType.Int16)
    if "many" in options:
        index = await server.register_namespace("urn:g7:chart")
        for k in range(1000):
            await top.add_variable(ua.NodeId(f"w{k}", index), f"w{k}", k, ua.VariantType.Int16)
    await server.start()
    return server, nodes


async def main(arguments):
    logging.disable(logging.CRITICAL)
    server, nodes = await start(int(arguments[0]), arguments[1:])
    print(server.bserver._server.sockets[0].getsockname()[1], flush=True)
    async for words in lines():
        if words[0] == "stall":
            print("ok", flush=True)
            time.sleep(float(words[1]))
            continue
        node = nodes[words[1]]
        if words[0] == "set":
            status = getattr(ua.StatusCodes, words[3] if len(words) > 3 else "Good")
            value = ua.Variant(json.loads(words[2]), NODES[words[1]][1])
            await node.write_value(ua.DataValue(value, ua.StatusCode(status)))
            print("ok", flush=True)
        else:
            print(json.dumps(await node.read_value()), flush=True)
    await server.stop()


asyncio.run(main(sys.argv[1:]))
