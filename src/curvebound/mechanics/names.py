"""Names in generated source: those of the blackboard, where mechanics.py gives a symbol one."""

from __future__ import annotations

import keyword
import re
from collections.abc import Mapping
from typing import Any

from sympy import Symbol

from .derivation import Derivation
from .elements import Coordinate, Mass, Rate, Shape
from .source import identifier

__all__ = ["Names"]

#: locals of the methods, and modules
_LOCALS = frozenset(
    (
        *("a0", "a1", "t", "h", "ex", "ey", "gx", "gy", "first", "values", "state", "group"),
        *("power", "fed", "duration", "parameters", "choices", "inverse", "math", "self"),
        *("slope", "bend", "reach", "turns", "unwind", "normal", "far", "now", "rate", "expected"),
    )
)
#: fields that every model has
_FIELDS = frozenset(
    (
        *("q0", "q1", "v0", "v1", "x", "y", "vx", "vy", "ax", "ay", "work", "turns", "turns1"),
        *("jx", "jy", "inputs", "slopes", "input_count", "uses_rates"),
        *(
            "moving",
            "works",
            "settles",
            "plain",
            "pushed",
            "damped",
            "reshapes",
            "fresh",
            "magnification",
            *(
                f"{of}{i}"
                for of in ("inertia", "ahead", "narrow", "least", "most", "bends")
                for i in "01"
            ),
            *("apart", "pushed_by", "closest"),
            "kinetic",
            "potential",
        ),
        *("potential_size", "initial_energy", "is_linear", "is_constant", "projects"),
    )
)


class Names:
    """Identifiers of the symbols of a derivation.

    title: of the module. stated: the global names of mechanics.py.
    """

    def __init__(self, title: str, derivation: Derivation, stated: Mapping[str, Any]) -> None:
        self.title = title
        own: dict[Symbol, str] = {}
        for name, value in stated.items():
            if isinstance(value, Symbol):
                own.setdefault(value, name)
            elif isinstance(value, Mass):
                own.setdefault(value.mass, f"m_{name}")
                for axis, force in zip("xy", value.force, strict=True):
                    own.setdefault(force, f"f_{name}_{axis}")
        self._own = own
        self._of: dict[Symbol, str] = {}
        mechanics = derivation.mechanics
        for c in (*mechanics.coordinates, *mechanics.shapes):
            self._give(c, own.get(c) or identifier(c.name))
            self._give(c.rate, f"{self[c]}_rate")
            if isinstance(c, Shape):
                self._give(c.acceleration, f"{self[c]}_acceleration")

    def _give(self, symbol: Symbol, wanted: str) -> None:
        name = re.sub(r"\W", "_", wanted)
        taken = _LOCALS | set(self._of.values())
        if not isinstance(symbol, Coordinate | Rate):  # those are no fields
            taken |= _FIELDS
        while name in taken or keyword.iskeyword(name) or re.fullmatch(r"[kx]\d+", name):
            name += "_"
        self._of[symbol] = name

    def __getitem__(self, symbol: Symbol) -> str:
        if symbol not in self._of:
            self._give(symbol, self._own.get(symbol) or identifier(symbol.name))
        return self._of[symbol]
