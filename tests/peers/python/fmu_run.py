"""Runs FMUs by FMPy, scan by scan, after it has checked their description.

    fmu_run.py PLAN

PLAN is a JSON file, a list of FMUs as folders. Each has its `folder`, the `period` of its scans in seconds, the
names of its `inputs` and of what is `seen`, and `rows`: the values of the inputs of each scan, and whether its step is
without an error. The answer, a line of JSON for each: {"problems": [...], "before": [values before the first scan],
"seen": [values behind each scan, or null behind an error], "logged": [messages]}; reals are their bits. In the middle of each run the state is saved as bytes, another step is
made with it, and the state is read back; a second instance runs beside with other inputs.
"""

import json
import struct
import sys

from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    calloc,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    free,
)
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu


def instance(folder, description, name, logged):
    arguments = dict(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=name,
    )
    if description.fmiVersion == "2.0":
        def logger(environment, instance, status, category, message):
            logged.append([status, category.decode(), message.decode()])

        functions = fmi2CallbackFunctions()
        functions.logger = fmi2CallbackLoggerTYPE(logger)
        functions.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        functions.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        slave = FMU2Slave(**arguments)
        slave.instantiate(callbacks=functions)
        slave.kept = functions
    else:
        def logger(environment, status, category, message):
            logged.append([status, category.decode(), message.decode()])

        slave = FMU3Slave(**arguments)
        slave.instantiate(logMessage=logger)
    return slave


def start(slave, two, time):
    if two:
        slave.setupExperiment(startTime=time)
        slave.enterInitializationMode()
    else:
        slave.enterInitializationMode(startTime=time)
    slave.exitInitializationMode()


def put(slave, variable, value):
    getattr(slave, "set" + variable.type)([variable.valueReference], [value])


def take(slave, variable):
    value = getattr(slave, "get" + variable.type)([variable.valueReference])[0]
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, float):
        # Exactly, and those too for which JSON has no word.
        return "NaN" if value != value else struct.pack(">d", value).hex()
    return bool(value) if variable.type == "Boolean" else value


def run(fmu):
    folder, period, logged = fmu["folder"], fmu["period"], []
    description = read_model_description(folder)
    problems = [str(p) for p in validate_fmu(folder)]
    two = description.fmiVersion == "2.0"
    variables = {v.name: v for v in description.modelVariables}
    inputs = [variables[name] for name in fmu["inputs"]]
    seen = [variables[name] for name in fmu["seen"]]
    slave = instance(folder, description, "one", logged)
    other = instance(folder, description, "two", [])
    start(other, two, 0.0)
    before = [take(slave, v) for v in seen]
    start(slave, two, 0.0)
    answer, time = [], 0.0

    def step(which, row):
        for variable, value in zip(inputs, row):
            put(which, variable, value)
        which.doStep(currentCommunicationPoint=time, communicationStepSize=period)

    for i, (row, fine) in enumerate(fmu["rows"]):
        if i == len(fmu["rows"]) // 2:
            save, load, free = (
                (slave.getFMUstate, slave.setFMUstate, slave.freeFMUstate)
                if two
                else (slave.getFMUState, slave.setFMUState, slave.freeFMUState)
            )
            state = save()
            size = (slave.serializeFMUstate if two else slave.serializeFMUState)(state)
            free(state)
            try:
                step(slave, fmu["rows"][0][0])
            except FMICallException:
                pass
            state = (slave.deSerializeFMUstate if two else slave.deserializeFMUState)(size)
            load(state)
            free(state)
        try:
            step(slave, row)
            answer.append([take(slave, v) for v in seen])
        except FMICallException:
            answer.append(None)
            slave.reset()
            start(slave, two, time + period)
        if i % 3 == 0 and fine:
            try:
                slave_time, time = time, (i // 3) * period
                step(other, fmu["rows"][-1 - i][0])
            except FMICallException:
                other.reset()
                start(other, two, time + period)
            finally:
                time = slave_time
        time += period
    slave.terminate()
    slave.freeInstance()
    other.freeInstance()
    return {"problems": problems, "before": before, "seen": answer, "logged": logged}


with open(sys.argv[1]) as file:
    for one in json.load(file):
        try:
            print(json.dumps(run(one)), flush=True)
        except Exception as error:
            problem = f"{type(error).__name__}: {error}"
            print(json.dumps({"problems": [problem], "before": [], "seen": [], "logged": []}), flush=True)
