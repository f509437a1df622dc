"""Runs function blocks in AWL by awlsim, scan by scan, with a time that is given.

    awl_run.py CASES

CASES is a JSON file, a list of charts. Each has its source (`file`) and its symbol table (`symbols`), the
members of the data block that are set before a scan (`inputs`) and read behind it (`shown`), each as a name
and an index or null, and `events`: "start", or a time in milliseconds with the words of the inputs. The
answer, a line of JSON for each chart: {"seen": [words behind each scan]} or {"error": reason}. A word of
BOOL is 0 or 1, of REAL its bits, of others a signed number.
"""

import contextlib
import io
import json
import sys

from awlsim.core.main import *  # noqa: F401,F403 (awlsim's modules find each other in this order)
from awlsim.core.symbolparser import *  # noqa: F401,F403
from awlsim.awlcompiler import *  # noqa: F401,F403
from awlsim.common.sources import AwlSource, SymTabSource
from awlsim.core.memory import AwlMemoryObject_asScalar, make_AwlMemoryObject_fromScalar

# The block is called as a program of its user would call it.
CALL = b"\nORGANIZATION_BLOCK OB 1\nBEGIN\n  CALL FB 1, DB 1;\nEND_ORGANIZATION_BLOCK\n"


def source(kind, path, more=b""):
    with open(path, "rb") as file:
        return kind(name=path, sourceBytes=file.read() + more)


class Controller:
    def __init__(self, case):
        sim = AwlSim()
        self.cpu = sim.getCPU()
        # Time stands still but for the events.
        self.cpu.updateTimestamp = lambda: None
        self.cpu.now = 0.0
        parser = AwlParser()
        parser.parseSource(source(AwlSource, case["file"], CALL))
        sim.loadSymbolTable(SymTabParser.parseSource(source(SymTabSource, case["symbols"])))
        sim.load(parser.getParseTree())
        sim.startup()
        self.sim = sim
        self.data = self.cpu.getDB(1).structInstance

    def field(self, name, index):
        field = self.data._struct.getField(name)
        if index is None:
            return field.offset, field.bitSize, field.dataType
        ty = field.dataType.arrayElementType
        # Tables of a chart begin at 0; the elements lie side by side.
        bits = index * ty.width
        return field.offset.addInt(bits // 8, bits % 8), ty.width, ty

    def set(self, name, index, word):
        offset, width, _ = self.field(name, index)
        value = make_AwlMemoryObject_fromScalar(word & ((1 << width) - 1), width)
        self.data.memory.store(offset, value)

    def get(self, name, index):
        offset, width, ty = self.field(name, index)
        word = AwlMemoryObject_asScalar(self.data.memory.fetch(offset, width))
        if width > 1 and ty.type != ty.TYPE_REAL and word >> (width - 1):
            word -= 1 << width
        return word


def play(case):
    seen, controller = [], Controller(case)
    for event in case["events"]:
        if event == "start":
            controller = Controller(case)
            continue
        now, words = event
        controller.cpu.now = now / 1000.0
        for (name, index), word in zip(case["inputs"], words):
            controller.set(name, index, word)
        controller.sim.runCycle()
        seen.append([controller.get(name, index) for name, index in case["shown"]])
    return seen


def main(path):
    with open(path, encoding="utf-8") as file:
        cases = json.load(file)
    for case in cases:
        said = io.StringIO()
        try:
            with contextlib.redirect_stdout(said):
                answer = {"seen": play(case)}
        except Exception as error:  # noqa: BLE001 (what awlsim says is the answer)
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)


main(sys.argv[1])
