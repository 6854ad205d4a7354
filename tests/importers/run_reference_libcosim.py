"""Run a cross-check folder's FMU in libcosim: run_reference_libcosim.py FMU STEP INPUTS NAME...

Before each step the inputs of the row of INPUTS, a CSV file, are set; prints the Real outputs, one
line after each step.
"""

import csv
import sys

from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

fmu, step, inputs, *names = sys.argv[1:]
with open(inputs, newline="") as stream:
    rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(stream)]
execution = CosimExecution.from_step_size(step_size=round(float(step) * 1e9))
slave = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="slave"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer=observer)
manipulator = CosimManipulator.create_override()
execution.add_manipulator(manipulator=manipulator)
variables = {v.name.decode(): v for v in execution.slave_variables(slave)}
references = [variables[name].reference for name in names]


def override(kind, function, row, of):
    chosen = {n: x for n, x in row.items() if n in variables and variables[n].type == kind.value}
    if chosen:
        function(slave, [variables[n].reference for n in chosen], [of(x) for x in chosen.values()])


for row in rows[:-1]:
    override(CosimVariableType.REAL, manipulator.slave_real_values, row, float)
    override(CosimVariableType.INTEGER, manipulator.slave_integer_values, row, int)
    execution.step()
    print(*(repr(x) for x in observer.last_real_values(slave, references)))
