"""Makes lists of FMI calls that may fail, in a process of its own: python call_worker.py FOLDER.

Reads lines of JSON from standard input until it ends, each a list of cases, a case being a list of
calls [name, argument, ...], each on a new instance of the FMU extracted to FOLDER. Writes one line
of JSON a case, the outcomes of its calls: status, error messages logged during the call, and what
was read. After fmi2Fatal the rest of a case is left out, since nothing may be called then.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
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


class Worker:
    """A process that runs this file for one FMU; it ends with this one, or where a case ends it."""

    def __init__(self, folder: Path) -> None:
        self.said = tempfile.TemporaryFile()  # noqa: SIM115
        self.process = subprocess.Popen(
            [sys.executable, __file__, str(folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.said, text=True,
        )  # fmt: skip

    def outcomes(self, cases: Sequence[Sequence[Call]]) -> Iterator[list[Outcome]]:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(json.dumps(cases) + "\n")
        self.process.stdin.flush()
        for case in cases:
            line = self.process.stdout.readline()
            if not line:
                status = self.process.wait()
                self.said.seek(0)
                raise AssertionError(
                    f"the process ended with status {status} in case {case}:\n"
                    + self.said.read().decode(errors="replace")
                )
            yield json.loads(line)


_workers: dict[Path, Worker] = {}


def outcomes_of(fmu: Extracted, cases: Sequence[Sequence[Call]]) -> list[list[Outcome]]:
    """Run this file over `cases`; a crash is an AssertionError that shows the case."""
    worker = _workers.get(fmu.folder)
    if worker is None or worker.process.poll() is not None:
        worker = _workers[fmu.folder] = Worker(fmu.folder)
    try:
        return list(worker.outcomes(cases))
    except BaseException:  # what it still has to say belongs to no other cases
        worker.process.kill()
        worker.process.wait()
        raise


def main() -> None:
    fmu = Extracted(Path(sys.argv[1]))
    for line in sys.stdin:
        for case in json.loads(line):
            print(json.dumps(Driver(fmu).case(case)), flush=True)


if __name__ == "__main__":
    main()
