"""Simulate an FMU in pathsim-fmi: run_pathsim.py FMU STEP COUNT VARIABLE...

Prints the Real outputs after each communication step. Its first event, at time 0, is a step.
"""

import sys

from pathsim import Simulation
from pathsim_fmi import CoSimulationFMU

fmu, step, count, *names = sys.argv[1:]
block = CoSimulationFMU(fmu, dt=float(step))
outputs = [
    v.name for v in block.fmu_wrapper.model_description.modelVariables if v.causality == "output"
]
places = [outputs.index(name) for name in names]
rows = []
wrapped = block._step_fmu


def stepping(t):
    wrapped(t)
    rows.append([block.outputs.to_array()[place] for place in places])


for event in block.events:
    event.func_act = stepping
simulation = Simulation([block], dt=float(step) / 2, log=False)
simulation.run(float(step) * (int(count) - 0.75))
for row in rows[: int(count)]:
    print(*(repr(float(x)) for x in row))
