"""The linear model of a system about a state: x' = A x + B u, y = C x + D u, with names and units.

Derivatives are taken of the derived equations in 50 digits by differences so small that nothing of
them is left: A, B, C and D are right to the last bit of a double.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cosim.formats import write_npz
from ..errors import CurveboundError, nearest, reading
from ..files import write_whole
from ..fmi.declaration import CHOICE, INPUT, OUTPUT, PARAMETER
from ..fmi.folder import find
from ..mechanics.derive import derive
from ..mechanics.derived import Derived
from ..mechanics.numeric import ManyDigits
from ..units import number
from .extras import require

__all__ = ["LinearModel", "linearize"]

_DIGITS = 50
_STEP = "1e-24"
_ITERATIONS = 60
#: what keeps a shape moving
_DRIVING = ("rate_start", "acceleration")
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class LinearModel:
    """x' = A (x - x0) + B (u - u0) + rest, y = y0 + C (x - x0) + D (u - u0).

    Attributes
    ----------
    A, B, C, D : arrays of float
        Shapes (n, n), (n, m), (p, n), (p, m) for n states, m inputs and p outputs.
    states, inputs, outputs : tuple of str
        Names in the order of rows and columns.
    units : dict of str to str
        Unit by name.
    x0, u0, y0 : arrays of float
        State, inputs and outputs about which it holds.
    rest : array of float, shape (n,)
        x' at the state itself, zero at an equilibrium.
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: dict[str, str]
    x0: Matrix
    u0: Matrix
    y0: Matrix
    rest: Matrix

    def data(self) -> dict[str, Any]:
        """All of it as numbers, lists and words."""
        arrays = ("A", "B", "C", "D", "x0", "u0", "y0", "rest")
        found: dict[str, Any] = {name: getattr(self, name).tolist() for name in arrays}
        found |= {name: list(getattr(self, name)) for name in ("states", "inputs", "outputs")}
        return {**found, "units": self.units}

    def write(self, path: Path) -> None:
        """Write .npz or .json; CurveboundError for another name."""
        data = self.data()
        if path.suffix.lower() == ".json":
            text = json.dumps(data, indent=1) + "\n"
            write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))
        elif path.suffix.lower() == ".npz":
            data["units"] = [data["units"][n] for n in (*self.states, *self.inputs, *self.outputs)]
            arrays: dict[str, Any] = {name: np.array(value) for name, value in data.items()}
            write_whole(path, lambda part: write_npz(part, arrays))
        else:
            raise CurveboundError(f"{path} is neither .npz nor .json: name it so.")


def linearize(
    system: str | Path,
    at: Mapping[str, float | str] | None = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    *,
    equilibrium: bool = False,
) -> LinearModel:
    """The linear model of a system about a state, right to the last bit.

    States are coordinates and rates, then position and velocity of the frame along the axes whose
    accelerations are among the inputs, and shapes whose accelerations are.

    Parameters
    ----------
    system : str or Path
        Its name or folder.
    at : mapping of str to float or str, optional
        Values of coordinates, rates, parameters and inputs that differ from the declared ones, in
        their units; enumerations by item.
    inputs : sequence of str, optional
        Columns of B and D (default: all inputs).
    outputs : sequence of str, optional
        Rows of C and D (default: the coordinates).
    equilibrium : bool
        Look for the state of rest next to `at` and linearise there.

    Returns
    -------
    LinearModel
        A (n, n), B (n, m), C (p, n), D (p, m) with names and units.

    Raises
    ------
    CurveboundError
        A name is unknown, there is no equilibrium or none is found, or scipy or mpmath is not
        installed.
    """
    require("study")
    import mpmath

    folder = find(system)
    if not (folder.path / "mechanics.py").is_file():
        raise CurveboundError(
            f"{folder.name} states no mechanics, from which a linear model is derived: name a "
            "system that has a mechanics.py."
        )
    derived = derive(folder.path / "mechanics.py", folder.name)
    declared = {v.name: v for v in folder.fmu().variables}
    known = [v.name for v in declared.values() if v.kind == INPUT]
    chosen_inputs = _checked(inputs, known, "input", known)
    offered = [v.name for v in declared.values() if v.kind == OUTPUT]
    chosen_outputs = _checked(outputs, offered, "output", list(derived.coordinates))
    values: dict[str, Any] = {
        v.name: v.start for v in declared.values() if v.kind in (PARAMETER, CHOICE, INPUT)
    }
    for name, value in (at or {}).items():
        key = name if name in values else f"{name}_start"
        if key not in values:
            raise CurveboundError(
                f"{folder.name} has no {name} to linearise at; "
                + nearest(name, [*derived.coordinates, *derived.rates, *values])
            )
        kind, unit = declared[key].type, declared[key].unit
        if isinstance(value, str):
            with reading(name):
                value = kind.number(value) if kind else number(value, unit)
        if not math.isfinite(value):
            raise CurveboundError(f"{name} = {value} is not finite: give a finite number.")
        values[key] = value
    with mpmath.workdps(_DIGITS):
        found = _Point(derived, values)
        if equilibrium:
            found.settle(folder.name, chosen_inputs)
        model = found.model(chosen_inputs, chosen_outputs)
    units = {n: declared[n].unit for n in (*model.states, *chosen_inputs, *chosen_outputs)}
    return LinearModel(**{**model.__dict__, "units": units})


def _checked(
    given: Sequence[str] | None, known: Sequence[str], what: str, usual: list[str]
) -> tuple[str, ...]:
    for name in given or ():
        if name not in known:
            raise CurveboundError(f"There is no {what} {name}; " + nearest(name, known))
    return tuple(usual if given is None else given)


class _Point:
    """The system's functions at a state, within mpmath's working precision."""

    def __init__(self, derived: Derived, values: Mapping[str, Any]) -> None:
        self.F = ManyDigits()
        self.derived = derived
        self.linear = derived.has_linear and values.get("model.fidelity") == 1
        self.values = {k: self.F.number(v) for k, v in values.items()}
        self.s = derived.at(self.F, self.values)

    def call(self, name: str, s: Mapping[str, Any]) -> Any:
        prefix = "linear_" if self.linear else ""
        function = self.derived.function(prefix + name)
        s = dict(s)
        frame = self.derived.frame
        if frame:
            for axis in "xy":
                push = s[f"{frame}.a{axis}"]
                s[f"field.{axis}"] = s[f"gravity.{axis}"] - push
                s[f"frame.a{axis}"] = push
                for n in (axis, f"v{axis}"):
                    s[f"frame.{n}"] = s.get(f"{frame}.{n}", s[f"frame.{n}"])
        if self.linear and name == "reactions":
            accelerations = self.derived.function("linear_accelerations")(self.F, s)
            s |= {f"acceleration.{i}": a for i, a in enumerate(accelerations)}
        return function(self.F, s)

    def settle(self, name: str, inputs: Sequence[str]) -> None:
        """Newton's method for a state of rest."""
        import mpmath

        driving = [f"{shape}_{n}" for shape in self.derived.shapes for n in _DRIVING]
        pushes = [f"{self.derived.frame}.a{axis}" for axis in "xy"]
        driving += [n for n in pushes if n in inputs]  # whose position is a state
        moving = [n for n in driving if self.values.get(n, 0) != 0]
        if moving:
            raise CurveboundError(
                f"{name} has no equilibrium with "
                + ", ".join(f"{n} = {float(self.values[n]):g}" for n in moving)
                + f": set {'them' if len(moving) > 1 else 'it'} to 0"
                + ", or choose inputs without it." * (moving[-1] in pushes)
            )
        for rate in self.derived.rates:
            self.s[rate] = self.F.number(0)
        coordinates = self.derived.coordinates
        n = len(coordinates)
        for _ in range(_ITERATIONS):
            a = mpmath.matrix(self.call("accelerations", self.s))
            slopes = mpmath.matrix([row[:n] for row in self.call("jacobian", self.s)])
            try:
                change = mpmath.lu_solve(slopes, -a)
            except ZeroDivisionError:
                break
            for c, x in zip(coordinates, change, strict=True):
                self.s[c] += x
            if max(abs(x) for x in change) < mpmath.mpf(10) ** (10 - _DIGITS):
                return
        raise CurveboundError(
            f"No equilibrium of {name} is found near "
            + ", ".join(f"{c} = {float(self.values[f'{c}_start'])!r}" for c in coordinates)
            + ": start nearer to one, or hold the system by inputs that balance it."
        )

    def model(self, inputs: Sequence[str], outputs: Sequence[str]) -> LinearModel:
        derived = self.derived
        pairs = list(zip(derived.coordinates, derived.rates, strict=True))
        rates: list[Callable[[Mapping[str, Any]], Any]] = []
        for axis in "xy":
            if f"{derived.frame}.a{axis}" in inputs:
                pairs.append((f"{derived.frame}.{axis}", f"{derived.frame}.v{axis}"))
                rates.append(lambda s, n=f"{derived.frame}.a{axis}": s[n])  # type: ignore[misc]
        for shape in derived.shapes:
            if f"{shape}_acceleration" in inputs:
                pairs.append((shape, f"{shape}_rate"))
                rates.append(lambda s, n=f"{shape}_acceleration": s[n])  # type: ignore[misc]
        states = [name for pair in pairs for name in pair]
        at = dict(self.s)
        for name in states:
            at.setdefault(name, self.F.number(0))

        def motion(s: Mapping[str, Any]) -> list[Any]:
            turning = [*self.call("accelerations", s), *(rate(s) for rate in rates)]
            return [x for (_, v), a in zip(pairs, turning, strict=True) for x in (s[v], a)]

        def observed(s: Mapping[str, Any]) -> list[Any]:
            found = dict(s)
            for group in ("places", "energies", "reactions"):
                if not all(name in found for name in outputs):
                    found |= self.derived_group(group, s)
            return [found.get(name, self.F.number(0)) for name in outputs]

        step = self.F.number(_STEP)

        def slopes(f: Callable[[Mapping[str, Any]], list[Any]], by: Sequence[str]) -> Matrix:
            columns = []
            for name in by:
                ahead, back = f({**at, name: at[name] + step}), f({**at, name: at[name] - step})
                pairs = zip(ahead, back, strict=True)
                columns.append([float((x - y) / (2 * step)) for x, y in pairs])
            found: Matrix = np.array(columns, dtype=float).reshape(len(by), len(f(at))).T
            return found

        return LinearModel(
            A=slopes(motion, states),
            B=slopes(motion, inputs),
            C=slopes(observed, states),
            D=slopes(observed, inputs),
            states=tuple(states),
            inputs=tuple(inputs),
            outputs=tuple(outputs),
            units={},
            x0=np.array([float(at[n]) for n in states]),
            u0=np.array([float(at[n]) for n in inputs]),
            y0=np.array([float(x) for x in observed(at)]),
            rest=np.array([float(x) for x in motion(at)]),
        )

    def derived_group(self, group: str, s: Mapping[str, Any]) -> dict[str, Any]:
        """Outputs of one of the functions places, energies and reactions."""
        if group == "places":
            linear, self.linear = self.linear, False
            try:
                found: dict[str, Any] = self.call(group, s)
            finally:
                self.linear = linear
            return found
        found = self.call(group, s)
        if group == "energies":
            found = {**found, "energy.total": found["energy.kinetic"] + found["energy.potential"]}
        return found
