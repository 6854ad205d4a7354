"""Simulate an FMU in ecos: run_ecos.py FMU STEP COUNT VARIABLE...

Prints the Real outputs, one line after each step.
"""

import sys

from ecospy import EcosSimulation, EcosSimulationStructure

fmu, step, count, *names = sys.argv[1:]
with EcosSimulationStructure() as structure:
    structure.add_model("slave", fmu)
    with EcosSimulation(structure=structure, step_size=float(step)) as simulation:
        simulation.init()
        for _ in range(int(count)):
            simulation.step()
            print(*(repr(simulation.get_real(f"slave::{name}")) for name in names))
        simulation.terminate()
