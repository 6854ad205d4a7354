"""All that follows from a mechanics.py, as plain data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

__all__ = ["Derived", "Implied"]

#: functions of equations.py: (F, values of symbols by name) -> list, or dictionary of outputs
Function = Callable[[Any, Mapping[str, Any]], Any]


class Implied(NamedTuple):
    """A variable that follows from the statement; kind: parameter, choice, input or output.

    minimum: of its domain, itself excluded if `above`. of: the variable whose unit this one has,
    per s as often as `per_second` says, where that is not known here.
    """

    kind: str
    name: str
    unit: str
    start: float
    description: str
    minimum: float | None = None
    above: bool = False
    of: str = ""
    per_second: int = 0


@dataclass(frozen=True)
class Derived:
    """A system's physics.

    coordinates, rates: names of the state's variables; angles: which are in rad. shapes: what has a
    prescribed motion. frame: name of what the positions are counted from, "" for the world.
    damping: coefficients; forces: inputs that are forces. Choices as in kernel_source.py.
    kernel: text of a kernel module. equations: text of equations.py's functions.
    """

    coordinates: tuple[str, ...]
    rates: tuple[str, ...]
    angles: tuple[bool, ...]
    masses: tuple[str, ...]
    shapes: tuple[str, ...]
    frame: str
    damping: tuple[str, ...]
    forces: tuple[str, ...]
    has_linear: bool
    has_constraint: bool
    variables: tuple[Implied, ...]
    kernel: str
    equations: str

    def function(self, name: str) -> Function:
        """A function of equations.py; KeyError for one that this system has not."""
        found: Function = _functions(self.equations)[name]
        return found

    def at(self, F: Any, values: Mapping[str, Any], t: Any = 0) -> dict[str, Any]:
        """Symbols t s after the start by name, for `function`, from values by variable name.

        values: parameters, start values and inputs that are held from the start on (0 where they
        are missing); their numbers should be those of F. Coordinates and rates are at their start.
        """
        s = dict(values)
        for v in self.variables:
            if v.kind == "input":
                s.setdefault(v.name, 0)
        s |= {f"frame.{n}": 0 for n in ("x", "y", "vx", "vy", "ax", "ay")}
        for axis in "xy":
            if self.frame:
                push = s[f"{self.frame}.a{axis}"]
                s[f"frame.a{axis}"] = push
                s[f"frame.v{axis}"] = push * t
                s[f"frame.{axis}"] = push * t * t / 2
            s[f"field.{axis}"] = s[f"gravity.{axis}"] - s[f"frame.a{axis}"]
        for name in self.shapes:
            start, rate = s[f"{name}_start"], s[f"{name}_rate_start"]
            push = s[f"{name}_acceleration"]
            s[name] = start + t * (rate + t * push / 2)
            s[f"{name}_rate"] = rate + t * push
        for name in (*self.coordinates, *self.rates):
            s[name] = s[f"{name}_start"]
        return s


@lru_cache(maxsize=64)
def _functions(text: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {}
    exec(compile(text, "equations derived by curvebound", "exec"), namespace)
    return namespace
