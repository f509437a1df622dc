"""A Modbus master of pymodbus for tests.

Argument: the port of a server on this machine. It prints `connected`, then obeys lines on the standard
input: `read AREA ADDRESS COUNT`, `write AREA ADDRESS VALUE...`; the areas are those of an io file. It
prints the values, `ok`, or `exception NUMBER`.
"""

import sys
import time

from pymodbus.client import ModbusTcpClient


def connected(port):
    client = ModbusTcpClient("127.0.0.1", port=port, timeout=3)
    end = time.monotonic() + 20
    while not client.connect():
        if time.monotonic() > end:
            sys.exit("nobody listens")
        time.sleep(0.05)
    return client


def answer(client, verb, area, address, values):
    if verb == "read":
        read = {
            "coil": client.read_coils,
            "discrete": client.read_discrete_inputs,
            "holding": client.read_holding_registers,
            "input": client.read_input_registers,
        }[area]
        result = read(address, count=values[0])
    elif area == "coil":
        bits = [value != 0 for value in values]
        result = client.write_coil(address, bits[0]) if len(bits) == 1 else client.write_coils(address, bits)
    elif len(values) == 1:
        result = client.write_register(address, values[0])
    else:
        result = client.write_registers(address, values)
    if result.isError():
        return f"exception {result.exception_code}"
    if verb == "write":
        return "ok"
    found = result.bits if area in ("coil", "discrete") else result.registers
    return " ".join(str(int(value)) for value in found[: values[0]])


client = connected(int(sys.argv[1]))
print("connected", flush=True)
for line in sys.stdin:
    verb, area, address, *values = line.split()
    print(answer(client, verb, area, int(address), [int(value) for value in values]), flush=True)
