"""Time integration: one method per file behind one interface (base.Method)."""

from __future__ import annotations

from .adaptive import Adaptive
from .exact import Exact
from .explicit_euler import ExplicitEuler
from .implicit import Implicit
from .method import Method
from .rk4 import RK4
from .semi_implicit_euler import SemiImplicitEuler

__all__ = ["METHODS", "create"]

#: items 1, 2, ... of the enumeration SolverMethod
METHODS = ("explicit_euler", "semi_implicit_euler", "rk4", "adaptive", "implicit", "exact")


def create(item: int) -> Method:
    """A new instance of METHODS[item - 1]; raises IndexError for an item that does not exist."""
    if item == 1:
        return ExplicitEuler()
    if item == 2:
        return SemiImplicitEuler()
    if item == 3:
        return RK4()
    if item == 4:
        return Adaptive()
    if item == 5:
        return Implicit()
    if item == 6:
        return Exact()
    raise IndexError(f"there is no integration method {item}; choose 1 to {len(METHODS)}")
