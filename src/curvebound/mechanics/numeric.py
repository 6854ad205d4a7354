"""Numbers in which derived equations are evaluated: extended precision, or many digits.

An instance is the F of the functions of equations.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["ManyDigits", "double", "extended"]


class _Array:
    """numpy's functions, element by element over arrays."""

    sin, cos, tan, exp, log = np.sin, np.cos, np.tan, np.exp, np.log
    asin, acos, atan, atan2 = np.arcsin, np.arccos, np.arctan, np.arctan2
    sinh, cosh, tanh = np.sinh, np.cosh, np.tanh
    fabs, sqrt, copysign = np.abs, np.sqrt, np.copysign


class _Extended(_Array):
    """numpy's extended precision."""

    pi = 4 * np.arctan(np.longdouble(1))

    @staticmethod
    def ratio(p: int, q: int) -> Any:
        """p / q."""
        return np.longdouble(p) / q

    @staticmethod
    def number(x: Any) -> Any:
        """A number of this kind."""
        return np.longdouble(x)


class _Double(_Array):
    """Double precision."""

    pi = np.pi
    number = staticmethod(float)

    @staticmethod
    def ratio(p: int, q: int) -> float:
        """p / q."""
        return p / q


extended = _Extended()
double = _Double()


class ManyDigits:
    """mpmath's numbers; use within mpmath.workdps(digits)."""

    def __init__(self) -> None:
        import mpmath as mp

        self.sin, self.cos, self.tan, self.exp, self.log = mp.sin, mp.cos, mp.tan, mp.exp, mp.log
        self.asin, self.acos, self.atan, self.atan2 = mp.asin, mp.acos, mp.atan, mp.atan2
        self.sinh, self.cosh, self.tanh = mp.sinh, mp.cosh, mp.tanh
        self.fabs, self.sqrt = mp.fabs, mp.sqrt
        self.number = mp.mpf
        self._mp = mp

    @staticmethod
    def copysign(x: Any, y: Any) -> Any:
        """x, which is positive, with the sign of y."""
        return x if y >= 0 else -x

    @property
    def pi(self) -> Any:
        """pi to the working precision."""
        return +self._mp.pi

    def ratio(self, p: int, q: int) -> Any:
        """p / q."""
        return self._mp.mpf(p) / q
