"""A Modbus slave of pymodbus for tests.

Arguments: the port of Modbus TCP, 0 for a free one, and the seconds after which its own watchdog
clears the coils where no request comes; or `serial` and the units on a serial line. It
prints its port or the line, then obeys lines on the standard input: `set AREA ADDRESS VALUE...`,
`get AREA ADDRESS COUNT`; the unit may stand before the area. The areas are those of an io file;
each has the addresses 0 to 199.
"""

import asyncio
import os
import select
import sys
import threading
import time
import tty

from lines import lines
from pymodbus.server import ModbusSerialServer, ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

CODES = {"coil": 1, "discrete": 2, "holding": 3, "input": 4}


def device(unit):
    def bits():
        return [SimData(0, count=200, values=False, datatype=DataType.BITS)]

    def registers():
        return [SimData(0, count=200, values=0, datatype=DataType.REGISTERS)]

    return SimDevice(id=unit, simdata=(bits(), bits(), registers(), registers()))


def serial_line(units):
    """Two ends of a serial line that are joined in this process, and the frames of some units."""
    ends = [os.openpty() for _ in range(2)]
    for end in ends:
        tty.setraw(end[1])
    masters = [end[0] for end in ends]

    def join():
        while True:
            for master in select.select(masters, [], [])[0]:
                other = masters[1 - masters.index(master)]
                frame = os.read(master, 1024)
                # pymodbus answers for units that it does not have; real ones are silent.
                if frame[0] in units:
                    os.write(other, frame)

    threading.Thread(target=join, daemon=True).start()
    return [os.ttyname(end[1]) for end in ends]


async def watchdog(server, heard, limit):
    """Clears the coils once no request has come for so many seconds."""
    while True:
        await asyncio.sleep(limit / 20)
        if time.monotonic() - heard[0] > limit:
            await server.async_setValues(1, CODES["coil"], 0, [False] * 200)


async def start(arguments):
    if arguments[0] == "serial":
        units = [int(unit) for unit in arguments[1:]]
        own, other = serial_line(units)
        devices = [device(unit) for unit in units]
        server = ModbusSerialServer(devices, port=own, baudrate=19200, parity="N")
        task = asyncio.create_task(server.serve_forever())
        await asyncio.sleep(0.3)
        return server, task, other
    heard = [time.monotonic()]

    def hear(sending, pdu):
        heard[0] = heard[0] if sending else time.monotonic()
        return pdu

    address = ("127.0.0.1", int(arguments[0]))
    server = ModbusTcpServer(device(1), address=address, trace_pdu=hear)
    if len(arguments) > 1:
        asyncio.create_task(watchdog(server, heard, float(arguments[1])))
    task = asyncio.create_task(server.serve_forever())
    while not getattr(server, "transport", None) or not server.transport.sockets:
        await asyncio.sleep(0.01)
    return server, task, server.transport.sockets[0].getsockname()[1]


async def main(arguments):
    server, task, where = await start(arguments)
    print(where, flush=True)
    async for words in lines():
        verb, *words = words
        unit = int(words.pop(0)) if words[0].isdigit() else 1
        code, address = CODES[words[0]], int(words[1])
        if verb == "set":
            values = [int(word) for word in words[2:]]
            values = [value != 0 for value in values] if code < 3 else values
            await server.async_setValues(unit, code, address, values)
            print("ok", flush=True)
        else:
            count = int(words[2])
            found = await server.async_getValues(unit, code, address, count)
            print(*[int(value) for value in found[:count]], flush=True)
    await server.shutdown()
    task.cancel()


asyncio.run(main(sys.argv[1:]))
