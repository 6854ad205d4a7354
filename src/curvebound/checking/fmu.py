"""The checks of one FMU, ours or any of FMI 2.0 for co-simulation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..cosim.fmu import Value, read_fmu
from ..cosim.instance import CallFailed, Ended
from ..errors import CurveboundError, nearest
from .experiment import Runner
from .finding import FAILED, Finding, Skipped, Wrong, digest_of, found
from .reference import Distance
from .request import Request
from .subject import Subject

__all__ = ["CHECKS", "FmuCheck"]

Array = NDArray[np.float64]

_METHOD, _STEP = "solver.method", "solver.step"
#: a start value that differs by less, relative, is the same written with fewer digits
_SAME = 1e-6
#: of a halved step an error that is not yet small enough has to leave at most this part
_LESS = 0.75
#: errors are compared as long as they are this small, where halving the step acts as it should
_SMALL = 0.03


class FmuCheck:
    """All checks of the FMU at `path`; `findings` does one after the other."""

    def __init__(self, path: Path, request: Request) -> None:
        self.path = path
        self.request = request
        self.rows: Array | None = None  # of the default run
        self._described: Subject | None = None
        self._exactly: Distance | None = None

    def findings(self, begin: Callable[[str], None] = lambda name: None) -> Iterator[Finding]:
        """Each finding when it is there; begin: told the name of each check before.

        Where the description cannot be read or the default experiment fails the others are not
        done.
        """
        for name in CHECKS:
            begin(name)
            finding = found(name, partial(self._look, name))
            yield finding
            if finding.outcome == FAILED and (self._described is None or name == "simulation"):
                return

    def _look(self, name: str) -> str:
        look: Callable[[], str] = getattr(self, f"_{name}")
        try:
            return look()
        except CallFailed as failed:
            raise Wrong(failed.cause) from failed
        except Ended as ended:
            raise Wrong(str(ended)) from ended
        except CurveboundError as error:
            raise Wrong(str(error)) from error

    def digest(self) -> dict[str, str]:
        """A hash of each output of the default run, which is made where it was not yet."""
        if self.rows is None:
            self._described = self._described or Subject(read_fmu(self.path), self.request)
            self._simulation()
        assert self.rows is not None
        return digest_of(self._runner.names, self.rows)

    @property
    def _subject(self) -> Subject:
        assert self._described is not None
        return self._described

    @property
    def _runner(self) -> Runner:
        return self._subject.runner

    # the checks, in the order of CHECKS

    def _description(self) -> str:
        from fmpy.validation import validate_fmu

        fmu = read_fmu(self.path)
        self._described = Subject(fmu, self.request)
        problems = validate_fmu(str(self.path))
        if problems:
            raise Wrong(
                f"{len(problems)} problems, the first: {' '.join(str(problems[0]).split())}"
            )
        return f"{len(fmu.variables)} variables, fmpy finds no fault"

    def _simulation(self) -> str:
        runner = self._runner
        self.rows = rows = runner.run()
        points = runner.experiment.points
        wrong = [n for n, values in zip(runner.names, rows.T, strict=True) if _odd(values)]
        if wrong:
            first = rows[:, runner.names.index(wrong[0])]
            time = float(points[int(np.flatnonzero(~np.isfinite(first))[0])])
            raise Wrong(f"{wrong[0]} is {first[~np.isfinite(first)][0]} at t = {time:.6g} s")
        said = "".join(f"; it warns: {one}" for one in runner.log.warnings()[:1])
        return f"{points[-1] - points[0]:g} s in {len(points) - 1} steps{said}"

    def _starts(self) -> str:
        """That the binary starts where the description says."""
        runner = self._runner
        fmu = runner.fmu
        declared = [
            v
            for v in fmu.variables.values()
            if v.start is not None and v.kind != "String" and v.variability != "constant"
            and (v.causality == "input" or v.initial == "exact")
            and v.name not in runner.experiment.start and v.name not in runner.experiment.inputs
        ]  # fmt: skip
        with runner.instance() as made:
            runner.begin(made)
            values = runner.values(made, declared)
        wrong = []
        for variable, value in zip(declared, values, strict=True):
            said = float(variable.value(str(variable.start)))
            if not abs(value - said) <= _SAME * abs(said):
                wrong.append(f"{variable.name} starts at {value!r}, the description says {said!r}")
        if wrong:
            more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
            raise Wrong(wrong[0] + more)
        return f"{len(declared)} start values are those of the description"

    def _against_reference(self) -> str:
        table = self._subject.reference
        if table is None:
            raise Skipped("it carries no reference result; give one with --reference FILE.csv")
        assert self.rows is not None
        self._exactly = distance = self._subject.distance(self.rows)
        if not distance.relative <= self.request.tolerance:
            raise Wrong(self._subject.too_far(distance))
        off = f"{distance.name} is off by {distance.relative:.1e} of the largest value at most"
        return f"{table.path.name}: {off}"

    def _bounds(self) -> str:
        runner = self._runner
        if not self.request.most:
            raise Skipped("no bound was given (--max)")
        assert self.rows is not None
        told = []
        for name, bound in self.request.most.items():
            if name not in runner.names:
                raise Wrong(f"{name} is no output; {nearest(name, runner.names)}")
            values = np.abs(self.rows[:, runner.names.index(name)])
            unit = runner.fmu.variables[name].unit or ""
            told.append(f"{name} reaches {values.max():.3g}, {bound:g} {unit}".rstrip())
            told[-1] += " is allowed"
            if not values.max() <= bound:
                time = float(runner.experiment.points[int(np.flatnonzero(~(values <= bound))[0])])
                raise Wrong(f"{told[-1]} (exceeded first at t = {time:.6g} s)")
        return "; ".join(told)

    def _reset(self) -> str:
        runner = self._runner
        with runner.instance() as made:
            runner.begin(made)
            runner.advance(made)
            made.terminate()
            if not made.reset():
                raise Wrong("fmi2Reset fails after fmi2Terminate")
            runner.begin(made)
            rows = runner.advance(made)
        assert self.rows is not None
        self._same(rows, self.rows, 0, "after fmi2Reset")
        return "a second run after fmi2Reset has the same bits"

    def _states(self) -> str:
        runner = self._runner
        if not runner.fmu.can_roll_back:
            raise Skipped("it cannot save states, as it says (canGetAndSetFMUstate)")
        methods = self._methods_there() or [""]
        for method in methods:
            try:
                self._state_of(method)
            except CallFailed as failed:
                if not method or not _refused(failed, method):
                    raise
            except Wrong as wrong:
                raise Wrong(f"{method}: {wrong}" if method else str(wrong)) from None
        moved = ", in another instance too" if self._movable() else ""
        return f"a restored state goes on with the same bits{moved}"

    def _methods(self) -> str:
        if not self._methods_there():
            raise Skipped(f"it has no enumeration {_METHOD}")
        told = []
        for method in self._methods_there():
            try:
                rows = self._runner.run({_METHOD: method})
            except CallFailed as failed:
                if not _refused(failed, method):
                    raise Wrong(f"{method}: {failed.cause}") from failed
                told.append(f"{method} refused by its message")
                continue
            told.append(f"{method} {self._error_of(method, rows)}".strip())
        given = "" if self._exactly is None else "errors relative to the largest value: "
        return given + ", ".join(told)

    # what they share

    def _methods_there(self) -> list[str]:
        method = self._subject.fmu.variables.get(_METHOD)
        if method is None or not method.items or not method.is_settable_start:
            return []
        return list(method.items)

    def _error_of(self, method: str, rows: Array) -> str:
        """The error of a method in words; Wrong where it is too large and does not fall."""
        if _odd(rows):
            raise Wrong(f"{method}: an output is no finite number")
        if self._exactly is None:
            return ""
        distance = self._subject.distance(rows)
        step = self._subject.fmu.variables.get(_STEP)
        if not distance.relative <= self.request.tolerance and step is not None:
            half = 0.5 * float(self.request.start.get(_STEP, step.start or 1.0))
            coarse = self._subject.off(rows)
            fine = self._subject.off(self._runner.run({_METHOD: method, _STEP: half}))
            small = int(np.argmax(coarse > _SMALL)) or len(coarse)
            errors = float(coarse[:small].max()), float(fine[:small].max())
            if not errors[1] <= max(_LESS * errors[0], self.request.tolerance):
                raise Wrong(
                    f"{method}: an output is off by {errors[0]:.2g} of the largest value, and with "
                    f"half the step by {errors[1]:.2g}"
                )
        return f"{distance.relative:.1e}"

    def _movable(self) -> bool:
        fmu = self._subject.fmu
        return fmu.can_serialize and not fmu.only_once_per_process

    def _state_of(self, method: str) -> None:
        """Save in the middle, go on, restore, go on again; and in another instance."""
        runner = self._runner
        changes: dict[str, Value] = {_METHOD: method} if method else {}
        half = (len(runner.experiment.points) - 1) // 2
        with runner.instance() as made:
            runner.begin(made, changes)
            runner.advance(made, 0, half)
            made.save()
            first = runner.advance(made, half)
            made.restore()
            at = np.zeros((1, len(runner.names)))
            runner.read(made, at[0])
            self._same(at, first[:1], half, "when the state is restored")
            again = runner.advance(made, half)
            self._same(
                again, first, half, "after fmi2SetFMUstate: the state does not hold everything"
            )
            if self._movable():
                made.restore()
                with runner.instance() as other:
                    runner.begin(other, changes)
                    runner.moved(made, other)
                    self._same(
                        runner.advance(other, half), first, half,
                        "after fmi2DeSerializeFMUstate in another instance",
                    )  # fmt: skip

    def _same(self, rows: Array, before: Array, first: int, when: str) -> None:
        """Wrong unless two runs, both from point `first` on, have the same bits."""
        runner = self._runner
        different = ~((rows == before) | (np.isnan(rows) & np.isnan(before)))
        if not different.any():
            return
        k, i = np.argwhere(different)[0]
        now, then = float(rows[k, i]), float(before[k, i])
        raise Wrong(
            f"{runner.names[i]} is {now!r} and was {then!r} at "
            f"t = {runner.experiment.points[first + k]:.6g} s, {when}"
        )


#: the checks by name, in their order: the method _NAME of FmuCheck does each
CHECKS = (
    "description", "simulation", "starts", "against_reference", "bounds", "reset", "states",
    "methods",
)  # fmt: skip


def _odd(values: Array) -> bool:
    return not bool(np.isfinite(values).all())


def _refused(failed: CallFailed, method: str) -> bool:
    """Whether a method was refused with a word on it, as it does not go with other settings."""
    return failed.function.endswith("InitializationMode") and (
        _METHOD in failed.cause or method in failed.cause
    )
