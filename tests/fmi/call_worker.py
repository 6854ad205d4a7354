"""Makes lists of FMI calls that may fail, in a process of its own: python call_worker.py FOLDER.

Reads cases from standard input as JSON, a case being a list of calls [name, argument, ...], each
on a new instance of the FMU extracted to FOLDER. Writes one line of JSON a case, the outcomes of
its calls: status, error messages logged during the call, and what was read. After fmi2Fatal the
rest of a case is left out, since nothing may be called then.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness import FATAL, OK, Extracted, Instance

Call = Sequence[Any]
#: status, errors and value of a call
Outcome = dict[str, Any]


class Driver:
    """Carries out the calls of one case."""

    def __init__(self, fmu: Extracted) -> None:
        self.instance = Instance(fmu)
        self.saved: Any = None

    def call(self, name: str, *arguments: Any) -> tuple[int, Any]:
        """Status and, where something is read, its value."""
        instance = self.instance
        slave = instance.slave
        values: list[Any] = []

        def read(function: str, *given: Any) -> int:
            def keep(*_: Any) -> None:
                values.append(getattr(slave, function)(*given))

            slave.keep = keep
            return instance.status("keep")

        if name == "setup":
            start_time, stop_time, tolerance = arguments
            return instance.status("setupExperiment", tolerance, start_time, stop_time), None
        if name == "set":
            status = OK
            for variable, value in arguments[0].items():
                v = instance.fmu.variables[variable]
                number = instance.fmu.number(variable, value)
                if v.type == "Real":
                    status = max(status, instance.status("setReal", [v.valueReference], [number]))
                else:
                    status = max(
                        status, instance.status("setInteger", [v.valueReference], [int(number)])
                    )
            return status, None
        if name == "outputs":
            status = read("getReal", instance._reals)
            return status, [x for some in values for x in some]
        if name == "get":
            v = instance.fmu.variables[arguments[0]]
            status = read("getReal" if v.type == "Real" else "getInteger", [v.valueReference])
            return status, values[0][0] if values else None
        if name == "state":
            return OK, instance.inner_state().decode()
        if name == "save":
            self.saved = slave.getFMUstate()
            return OK, None
        if name == "restore":
            return instance.status("setFMUstate", self.saved), None
        if name.startswith("get"):
            status = read(name, *arguments)
            return status, str(values[0]) if values else None
        return instance.status(name, *arguments), None

    def case(self, calls: Sequence[Call]) -> list[Outcome]:
        outcomes = []
        for call in calls:
            before = len(self.instance.errors)
            status, value = self.call(*call)
            errors = self.instance.errors[before:]
            outcomes.append({"status": status, "errors": errors, "value": value})
            if status == FATAL:
                break
        self.instance.free()
        return outcomes


def outcomes_of(fmu: Extracted, cases: Sequence[Sequence[Call]]) -> list[list[Outcome]]:
    """Run this file over `cases`; a crash is an AssertionError that shows the case."""
    done = subprocess.run(
        [sys.executable, __file__, str(fmu.folder)],
        input=json.dumps(cases),
        capture_output=True,
        text=True,
        timeout=300,
    )
    lines = done.stdout.splitlines()
    if done.returncode or len(lines) != len(cases):
        last = cases[len(lines)] if len(lines) < len(cases) else "after the last case"
        raise AssertionError(
            f"the process ended with status {done.returncode} in case {last}:\n{done.stderr}"
        )
    return [json.loads(line) for line in lines]


def main() -> None:
    fmu = Extracted(Path(sys.argv[1]))
    for case in json.load(sys.stdin):
        print(json.dumps(Driver(fmu).case(case)), flush=True)


if __name__ == "__main__":
    main()
