"""The motion of a system alone, with inputs held from the start on: equations and their slopes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...mechanics.derived import Derived
from ...mechanics.numeric import double, extended
from .equations import Array

__all__ = ["Accelerations", "Motion", "Slopes", "Values"]

#: t (n,), q (2, n), v (2, n) to q'' (2, n)
Accelerations = Callable[[Array, Array, Array], Array]
#: the same to d(q'')/d(q) and d(q'')/d(v), shape (2, 2, 2, n): of q or v, q'', by which
Slopes = Callable[[Array, Array, Array], Array]
Values = Mapping[str, float | str]


class Motion:
    """A system's equations at the values of its parameters, start values and inputs.

    damped: with its damping; what damping makes fast dies out. A system of one coordinate has a
    second one that rests.
    """

    def __init__(self, derived: Derived, values: Values, *, damped: bool = True) -> None:
        self.derived = derived
        real = {k: float(v) for k, v in values.items() if not isinstance(v, str)}
        if not damped:
            real |= dict.fromkeys(derived.damping, 0.0)
        self.linear = derived.has_linear and values.get("model.fidelity") == "linear"
        self._count = len(derived.coordinates)
        self._values = {F: {k: F.number(v) for k, v in real.items()} for F in (extended, double)}
        self._fixed = {F: derived.at(F, values) for F, values in self._values.items()}
        self._moves = any(real.get(f"{s}_rate_start", 0.0) != 0.0 for s in derived.shapes)
        self._moves |= any(real.get(f"{s}_acceleration", 0.0) != 0.0 for s in derived.shapes)
        names = (*derived.coordinates, *derived.rates)
        start = [real[f"{name}_start"] for name in names]
        n = self._count
        rest = [0.0] * (2 - n)
        #: q0, q1, v0, v1
        self.start: tuple[float, float, float, float]
        self.start = (*start[:n], *rest, *start[n:], *rest)  # type: ignore[assignment]

    def _at(self, F: Any, t: Any, q: Array, v: Array) -> dict[str, Any]:
        s = dict(self._fixed[F] if not self._moves else self.derived.at(F, self._values[F], t))
        for i in range(self._count):
            s[self.derived.coordinates[i]] = q[i]
            s[self.derived.rates[i]] = v[i]
        return s

    def _call(self, name: str, F: Any, t: Any, q: Array, v: Array) -> Any:
        prefix = "linear_" if self.linear and name in ("accelerations", "jacobian") else ""
        return self.derived.function(prefix + name)(F, self._at(F, t, q, v))

    def accelerations(self, t: Array, q: Array, v: Array) -> Array:
        """q'' in extended precision, see Accelerations."""
        found = np.zeros(np.broadcast_shapes(np.shape(q), (2, 1)), dtype=np.longdouble)
        for i, a in enumerate(self._call("accelerations", extended, t, q, v)):
            found[i] = a
        return found

    def slopes(self, t: Array, q: Array, v: Array) -> Array:
        """Derivatives of the accelerations in double precision, see Slopes."""
        q, v = np.asarray(q, float), np.asarray(v, float)
        found = np.zeros((2, 2, 2, q.shape[1]))
        n = self._count
        with np.errstate(all="ignore"):
            rows = self._call("jacobian", double, np.asarray(t, float), q, v)
        for i, row in enumerate(rows):
            for k, slope in enumerate(row):
                found[k // n, i, k % n] = slope
        return found

    def rates(self, t: Array, q: Array, v: Array) -> Array:
        """Rates (1/s) at which the motion changes, shape (n,).

        The root of the spectral radius of d(q'')/d(q), and the rates at which its own velocities
        turn the directions in which its coordinates move the masses. Of one coordinate the
        acceleration itself counts with its slope: where one vanishes, the other is large.
        """
        t, q, v = (np.asarray(x, float) for x in (t, q, v))
        j = self.slopes(t, q, v)[0]
        if self._count == 1:
            turning = self._call("accelerations", double, t, q, v)[0] + 0.0 * q[0]
            radius = np.hypot(j[0, 0], turning / self.unit(t, q, v))
        else:
            half, product = 0.5 * (j[0, 0] + j[1, 1]), j[0, 0] * j[1, 1] - j[0, 1] * j[1, 0]
            inside = half * half - product
            radius = np.where(
                inside >= 0.0,
                np.abs(half) + np.sqrt(np.maximum(inside, 0.0)),
                np.sqrt(np.maximum(product, 0.0)),
            )
        found = np.sqrt(radius)
        if self.linear:
            return np.asarray(found)
        pairs = self._call("turning", double, t, q, v)
        for turned, slope in zip(pairs[::2], pairs[1::2], strict=True):
            with np.errstate(all="ignore"):
                rate = np.sqrt(np.float64(turned) / np.float64(slope)) + 0.0 * q[0]
            found = np.fmax(found, np.where(np.isfinite(rate), rate, 0.0))
        return np.asarray(found)

    def reach(self, coordinate: int) -> float:
        """How far (m) a unit of a coordinate moves the first mass that it moves, at the start."""
        q, v = np.array(self.start[:2])[:, None], np.array(self.start[2:])[:, None]
        masses = len(self.derived.masses)
        found = self._call("turning", double, 0.0, q, v)[1::2]
        sizes = [
            float(np.ravel(x)[0]) for x in found[masses * coordinate : masses * (coordinate + 1)]
        ]
        return math.sqrt(next((x for x in sizes if x > 0.0), 1.0))

    def unit(self, t: Any = 0.0, q: Array | None = None, v: Array | None = None) -> Any:
        """Size of the first coordinate in units of the second, or by itself.

        At the start, or at times t, (n,), in the states q and v, (2, n).

        Of an angle 1 (rad); of a length how far (m) a radian of the other coordinate moves a mass,
        else how far it goes until the direction of its path has turned.
        """
        if self.derived.angles[0]:
            return 1.0
        if q is None or v is None:
            q = np.array(self.start[:2])[:, None]
            v = np.array(self.start[2:])[:, None]
        if self._count == 2 and self.derived.angles[1]:
            return self.reach(1)
        slope, bend = self._call("scales", double, t, q, v)[:2]
        with np.errstate(all="ignore"):
            size = np.sqrt(np.float64(slope) / np.float64(bend)) + 0.0 * q[0]
        return np.where(np.isfinite(size), size, 1.0)
