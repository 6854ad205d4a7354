"""The equations of a system in extended precision, from its statement, in two forms.

Accelerations by Cauchy and Binet in the generalised coordinates, and Hamilton's equations in
coordinates and momenta: what both share is the statement, so no error of the derivation can hide.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ....mechanics.derived import Derived
from ....mechanics.numeric import extended
from .base import Array, Equations, Inputs, Number, Witness

__all__ = ["Hamilton", "Mechanical", "Symbols"]


class Symbols(dict[str, Any]):
    """Values of symbols by name: the state's as given, parameters and inputs when asked for.

    frame: name of the moving frame, or "".
    """

    def __init__(
        self, state: Mapping[str, Any], parameters: Mapping[str, Any], inputs: Inputs, frame: str
    ) -> None:
        super().__init__(state)
        self._parameters = parameters
        self._inputs = inputs
        self._frame = frame

    def __missing__(self, name: str) -> Any:
        what, _, axis = name.partition(".")
        if what == "field":
            value = self[f"gravity.{axis}"] - self[f"frame.a{axis}"]
        elif what == "frame":
            value = self._inputs[f"{self._frame}.{axis}"] if self._frame else Number(0)
        elif name in self._parameters:
            value = self._parameters[name]
        else:
            value = self._inputs[name]
        self[name] = value
        return value


class Mechanical(Equations):
    """Coordinates and rates; the frame's position and velocity; shapes and their rates."""

    def __init__(
        self, parameters: Mapping[str, Any], derived: Derived, *, linear: bool = False
    ) -> None:
        super().__init__(parameters)
        self.derived = derived
        self.linear = linear
        self.prefix = "linear_" if linear else ""
        self.frame = ("x", "y", "vx", "vy") if derived.frame else ()
        self.moved = [n for s in derived.shapes for n in (s, f"{s}_rate")]

    @property
    def motion(self) -> list[str]:
        """Names of coordinates and rates."""
        return [*self.derived.coordinates, *self.derived.rates]

    def start(self) -> list[Array]:
        zero = np.zeros(1, dtype=Number)
        p = self.parameters
        moving = [p[f"{name}_start"] for name in self.motion]
        return [*moving, *(zero for _ in self.frame), *(p[f"{n}_start"] for n in self.moved)]

    def symbols(self, state: Sequence[Array], inputs: Inputs) -> Symbols:
        """The symbols of a state."""
        names = [*self.motion, *(f"frame.{n}" for n in self.frame), *self.moved]
        known = dict(zip(names, state, strict=True))
        if not self.frame:
            known |= {f"frame.{n}": Number(0) for n in ("x", "y", "vx", "vy")}
        return Symbols(known, self.parameters, inputs, self.derived.frame)

    def call(self, function: str, symbols: Symbols) -> Any:
        """A function of the model that the parameters choose."""
        return self.derived.function(self.prefix + function)(extended, symbols)

    def accelerations(self, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        """Second derivatives of the coordinates."""
        found: list[Array] = self.call("accelerations", self.symbols(state, inputs))
        return found

    def prescribed(self, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        """Rates of what moves as it is told: frame and shapes."""
        s = self.symbols(state, inputs)
        found = [s[f"frame.{n}"] for n in ("vx", "vy", "ax", "ay")] if self.frame else []
        for name in self.derived.shapes:
            found += [s[f"{name}_rate"], s[f"{name}_acceleration"]]
        return found

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        n = len(self.derived.coordinates)
        turning = self.accelerations(state, inputs)
        return [*state[n : 2 * n], *turning, *self.prescribed(state, inputs)]

    def outputs(
        self, names: Sequence[str], time: Array, state: Sequence[Array], inputs: Inputs
    ) -> dict[str, Array]:
        s = self.symbols(state, inputs)
        out: dict[str, Array] = {name: s[name] for name in (*self.motion, *self.moved)}
        frame = self.derived.frame
        out |= {f"{frame}.{n}": s[f"frame.{n}"] for n in self.frame}
        zero = np.zeros_like(s[self.motion[0]])
        out |= dict.fromkeys(
            ("energy.residual", "constraint.drift", "model.acceleration_error"), zero
        )
        for group in (self._places, self._energies, self._reactions):
            if all(name in out for name in names):
                break
            out = {**group(s), **out}
        return {name: out[name] for name in names}

    def _places(self, s: Symbols) -> dict[str, Array]:
        found: dict[str, Array] = self.derived.function("places")(extended, s)
        return found

    def _energies(self, s: Symbols) -> dict[str, Array]:
        found: dict[str, Array] = self.call("energies", s)
        return {**found, "energy.total": found["energy.kinetic"] + found["energy.potential"]}

    def _reactions(self, s: Symbols) -> dict[str, Array]:
        if self.linear:  # Newton's law in exact geometry
            for i, a in enumerate(self.call("accelerations", s)):
                s[f"acceleration.{i}"] = a
        found: dict[str, Array] = self.call("reactions", s)
        return found


class Hamilton(Witness):
    """Momenta in place of the rates."""

    equations: Mechanical

    def start(self) -> list[Array]:
        e = self.equations
        state = e.start()
        n = len(e.derived.coordinates)
        momenta = e.call("momenta", e.symbols(state, {}))
        return [*state[:n], *momenta, *state[2 * n :]]

    def _with_rates(self, state: Sequence[Array], inputs: Inputs) -> Symbols:
        """The symbols of a state, rates from its momenta."""
        e = self.equations
        n = len(e.derived.coordinates)
        s = e.symbols(state, inputs)
        s |= {f"momentum.{i}": state[n + i] for i in range(n)}
        s |= dict(zip(e.derived.rates, e.call("velocities", s), strict=True))
        return s

    def rates(self, time: Array, state: Sequence[Array], inputs: Inputs) -> list[Array]:
        e = self.equations
        s = self._with_rates(state, inputs)
        velocities = [s[name] for name in e.derived.rates]
        return [*velocities, *e.call("pushes", s), *e.prescribed(state, inputs)]

    def common(self, state: Sequence[Array]) -> list[Array]:
        n = len(self.equations.derived.coordinates)
        s = self._with_rates(state, {})
        return [*state[:n], *(s[name] for name in self.equations.derived.rates), *state[2 * n :]]
