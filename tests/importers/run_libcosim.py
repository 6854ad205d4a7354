"""Simulate an FMU in libcosim: run_libcosim.py FMU STEP COUNT REFERENCE...

Prints the Real outputs, one line before the first step and one after each.
"""

import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

fmu, step, count, *references = sys.argv[1:]
execution = CosimExecution.from_step_size(step_size=int(float(step) * 1e9))
slave = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="slave"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer=observer)
for k in range(int(count) + 1):
    if k:
        execution.step()
        values = observer.last_real_values(
            slave_index=slave, variable_references=[int(r) for r in references]
        )
        print(*(repr(x) for x in values))
