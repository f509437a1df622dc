"""A controller of Siemens for tests: the server of python-snap7.

It prints its port, then obeys lines on the standard input: `set AREA BYTE VALUE...` and
`get AREA BYTE COUNT`, in bytes; an area is `db1`, `m`, `i` or `q`, of 200 bytes each.
"""

import logging
import socket
import sys

from snap7.server import Server
from snap7.type import SrvArea

logging.disable(logging.CRITICAL)
with socket.socket() as free:
    free.bind(("127.0.0.1", 0))
    port = free.getsockname()[1]
areas = {name: bytearray(200) for name in ("db1", "m", "i", "q")}
kinds = {"db1": (SrvArea.DB, 1), "m": (SrvArea.MK, 0), "i": (SrvArea.PE, 0), "q": (SrvArea.PA, 0)}
server = Server(log=False)
for name, (kind, number) in kinds.items():
    server.register_area(kind, number, areas[name])
server.start_to("127.0.0.1", port)
print(port, flush=True)
for line in sys.stdin:
    verb, area, byte, *values = line.split()
    at = int(byte)
    if verb == "set":
        data = bytes(int(value) for value in values)
        areas[area][at : at + len(data)] = data
        print("ok", flush=True)
    else:
        print(*areas[area][at : at + int(values[0])], flush=True)
server.stop()
