"""Runs an FMU of others by FMPy, without inputs, in steps of equal length.

    fmu_plant.py FMU STEP COUNT NAMES…

The answer, a line for each instant from 0 on: the values of the variables, with all digits.
"""

import sys

from fmpy import extract, instantiate_fmu, read_model_description

path, step, count, names = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
description = read_model_description(path)
fmu = instantiate_fmu(extract(path), description, "CoSimulation")
if description.fmiVersion == "2.0":
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
else:
    fmu.enterInitializationMode(startTime=0.0)
fmu.exitInitializationMode()
references = {v.name: v.valueReference for v in description.modelVariables}
take = fmu.getReal if description.fmiVersion == "2.0" else fmu.getFloat64
for i in range(count + 1):
    if i > 0:
        # The time of a scan is a whole number of nanoseconds.
        fmu.doStep(currentCommunicationPoint=(i - 1) * step, communicationStepSize=step)
    print(*(repr(take([references[name]])[0]) for name in names))
fmu.terminate()
fmu.freeInstance()
