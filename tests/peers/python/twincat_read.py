"""Reads a POU of TwinCAT (`.TcPOU`) by blark, a grammar of TwinCAT's Structured Text.

    twincat_read.py FILE

The answer is the number of its statements. An error is that of blark.
"""

import sys

from blark.parse import parse

count = 0
for result in parse(sys.argv[1]):
    if result.exception is not None:
        raise result.exception
    # The declaration has no statements; the implementation is a list of them.
    for item in result.transform().items:
        count += len(getattr(item, "statements", None) or [])
print(count)
