"""A Modbus TCP slave of pymodbus for tests.

Arguments: the port; 0 takes a free one. It prints its port, then obeys lines on the standard
input: `set AREA ADDRESS VALUE...`, `get AREA ADDRESS COUNT`. The areas are those of an io file;
each has the addresses 0 to 199.
"""

import asyncio
import sys
import threading

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

CODES = {"coil": 1, "discrete": 2, "holding": 3, "input": 4}


def bits():
    return [SimData(0, count=200, values=False, datatype=DataType.BITS)]


def registers():
    return [SimData(0, count=200, values=0, datatype=DataType.REGISTERS)]


async def main(port):
    device = SimDevice(id=1, simdata=(bits(), bits(), registers(), registers()))
    server = ModbusTcpServer(device, address=("127.0.0.1", port))
    task = asyncio.create_task(server.serve_forever())
    while not getattr(server, "transport", None) or not server.transport.sockets:
        await asyncio.sleep(0.01)
    print(server.transport.sockets[0].getsockname()[1], flush=True)
    loop, lines = asyncio.get_running_loop(), asyncio.Queue()

    def read():
        for line in sys.stdin:
            loop.call_soon_threadsafe(lines.put_nowait, line.split())
        loop.call_soon_threadsafe(lines.put_nowait, None)

    threading.Thread(target=read, daemon=True).start()
    while words := await lines.get():
        code, address = CODES[words[1]], int(words[2])
        if words[0] == "set":
            values = [int(word) for word in words[3:]]
            values = [value != 0 for value in values] if code < 3 else values
            await server.async_setValues(1, code, address, values)
            print("ok", flush=True)
        else:
            found = await server.async_getValues(1, code, address, int(words[3]))
            print(*[int(value) for value in found[: int(words[3])]], flush=True)
    await server.shutdown()
    task.cancel()


asyncio.run(main(int(sys.argv[1])))
