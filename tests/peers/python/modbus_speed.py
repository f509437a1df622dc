"""Times the client of pymodbus: reads of 100 registers, in us a read.

Arguments: the port, and the number of reads.
"""

import sys
import time

from pymodbus.client import ModbusTcpClient

port, reads = int(sys.argv[1]), int(sys.argv[2])
client = ModbusTcpClient("127.0.0.1", port=port)
assert client.connect()
begin = time.perf_counter()
for _ in range(reads):
    registers = client.read_holding_registers(0, count=100).registers
assert registers[99] == 99
print((time.perf_counter() - begin) * 1e6 / reads)
