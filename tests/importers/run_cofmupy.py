"""Simulate an FMU in cofmupy: run_cofmupy.py FMU STEP COUNT VARIABLE...

Prints the Real outputs, one line after each step.
"""

import json
import sys
from pathlib import Path

from cofmupy.coordinator import Coordinator

fmu, step, count, *names = sys.argv[1:]
configuration = Path("configuration.json")
configuration.write_text(json.dumps({"fmus": [{"id": "slave", "path": fmu, "name": "slave"}]}))
coordinator = Coordinator()
coordinator.start(str(configuration))
for _ in range(int(count)):
    coordinator.do_step(float(step))
results = coordinator.get_results()
columns = [list(results["slave", name])[-int(count) :] for name in names]
for row in zip(*columns, strict=True):
    print(*(repr(float(x)) for x in row))
