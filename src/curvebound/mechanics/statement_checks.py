"""What a statement is refused for: ValueErrors that name the thing, its value and the remedy."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import sympy
from sympy import Expr, Symbol

from ..naming import RULE, is_variable_name
from .elements import Constraint, Coordinate, Drag, Input, Mass, Parameter, Rate, Reaction, Shape
from .inertia import without_inertia
from .periodic import is_periodic
from .source import Printer

if TYPE_CHECKING:
    from .statement import Mechanics

__all__ = ["check", "planar"]

#: symbols of derivations
_RESERVED = {f"{what}.{axis}" for what in ("field", "position", "velocity") for axis in "xy"}
#: what generated code computes: this, and these functions
_PLAIN = (sympy.Symbol, sympy.Number, sympy.NumberSymbol, sympy.Add, sympy.Mul, sympy.Pow)
_FUNCTIONS = (*Printer.FUNCTIONS, "sign")
_INFINITE = (sympy.I, sympy.nan, sympy.zoo, sympy.oo, -sympy.oo)


def check(m: Mechanics) -> None:
    """Raise ValueError for what cannot be derived, or would be derived otherwise than meant."""
    _parts(m)
    _keys(m)
    _expressions(m)
    if m.constraint is not None:
        _cartesian(m)
    _names(m)
    lacking = without_inertia(m.coordinates, m.masses)
    if lacking:
        raise ValueError(lacking)


def planar(name: str, components: Sequence[Any]) -> None:
    """Raise ValueError unless there are two components, x and y."""
    if len(components) != 2:
        raise ValueError(
            f"{name} has {len(components)} components, {_listed(components)}: systems are planar, "
            "give x and y"
        )


def _listed(things: Iterable[Any]) -> str:
    return ", ".join(_shown(thing) for thing in things)


def _shown(thing: Any) -> str:
    """A thing as its author would call it."""
    if isinstance(thing, Mass):
        return f"mass {thing.name}"
    if isinstance(thing, Drag):
        return f"drag {thing.name}"
    if isinstance(thing, Symbol | Expr):
        return str(thing)
    return repr(thing)


# -- of what kind the parts are ------------------------------------------------------------------
def _parts(m: Mechanics) -> None:
    _list("coordinates", m.coordinates, Coordinate, "length(NAME) or angle(NAME)")
    _list("masses", m.masses, Mass, "mass(NAME, x, y)")
    _list("damping", m.damping, Drag, "drag(NAME, of)")
    for field in ("couples", "forces", "observed"):
        _dictionary(field, getattr(m, field))
    if m.linear_about is not None:
        _dictionary("linear_about", m.linear_about)
    if m.constraint is not None and not isinstance(m.constraint, Constraint):
        raise ValueError(f"constraint={m.constraint!r} is none: make it with Constraint(...)")
    if not 1 <= len(m.coordinates) <= 2:
        raise ValueError(
            f"coordinates=[{_listed(m.coordinates)}] are {len(m.coordinates)}: state one or two, "
            "and the positions of all masses by them"
        )
    for c, count in Counter(m.coordinates).items():
        if count > 1:
            raise ValueError(
                f"coordinate {c} is listed twice in coordinates=[{_listed(m.coordinates)}]: list "
                "it once, and name a second one otherwise"
            )
    if not m.masses:
        raise ValueError("no mass is declared: state at least one, with its position")
    if m.constraint is not None and (len(m.masses), len(m.coordinates)) != (1, 1):
        raise ValueError(
            "a constraint with a multiplier holds one mass of one coordinate, but there are "
            f"{len(m.masses)} masses and {len(m.coordinates)} coordinates: leave the constraint out"
        )


def _list(field: str, value: Any, kind: type, made_by: str) -> None:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ValueError(
            f"{field}={_shown(value)} is no list: give a list, {field}=[...], of what "
            f"{made_by} makes"
        )
    for one in value:
        if not isinstance(one, kind):
            raise ValueError(
                f"{_shown(one)} in {field} is no {kind.__name__.lower()}: make it with {made_by}"
            )


def _dictionary(field: str, value: Any) -> None:
    if not isinstance(value, Mapping):
        raise ValueError(f"{field}={value!r} is no dictionary: give one, {field}={{...: ...}}")


# -- to what they belong -------------------------------------------------------------------------
def _keys(m: Mechanics) -> None:
    for field in ("couples", "linear_about"):
        for key in getattr(m, field) or ():
            if key not in m.coordinates:
                raise ValueError(
                    f"{_shown(key)} in {field} is no coordinate of this statement: use what "
                    f"length() or angle() made as the key; coordinates are "
                    f"{_listed(m.coordinates)}"
                )
    for mass, force in m.forces.items():
        if mass not in m.masses:
            raise ValueError(_no_mass(m, mass, "forces"))
        if isinstance(force, str) or not hasattr(force, "__len__"):
            raise ValueError(
                f"the force {force!r} on {_shown(mass)} has no two components: give x and y, "
                "(fx, fy)"
            )
        planar(f"the force on {_shown(mass)}", force)
    for drag in m.damping:
        if isinstance(drag.of, Coordinate):
            if drag.of not in m.coordinates:
                raise ValueError(
                    f"{_shown(drag)} is of {drag.of}, which is no coordinate of this statement: "
                    f"coordinates are {_listed(m.coordinates)}"
                )
        elif drag.of not in m.masses:
            raise ValueError(_no_mass(m, drag.of, _shown(drag)))
    for c, at in (m.linear_about or {}).items():
        if not isinstance(at, int | float | Expr) or not math.isfinite(float(at)):
            raise ValueError(f"linear_about={{{c}: {at!r}}} is no number: give that of a rest")


def _no_mass(m: Mechanics, what: Any, where: str) -> str:
    return (
        f"{_shown(what)} in {where} is no mass of this statement: use what mass() made, and list "
        f"it in masses, which are {_listed(m.masses)}"
    )


# -- of what the expressions consist -------------------------------------------------------------
class _Stated(NamedTuple):
    """An expression, what it is, whether it is a force, and the reactions that it may contain."""

    what: str
    expression: Any
    is_force: bool = False
    reactions: tuple[Symbol, ...] = ()


def _expressions(m: Mechanics) -> None:
    stated = _every(m)
    found = {s for one in stated for s in _symbols(one)}
    of_shapes = {s.rate for s in found if isinstance(s, Shape)}
    rates = {c.rate for c in m.coordinates} | of_shapes
    for one in stated:
        for s in _symbols(one):
            if s in m.coordinates or isinstance(s, Shape):
                continue
            if type(s) is Parameter and s not in of_shapes:
                continue
            if one.is_force and (s in rates or type(s) is Input or s in one.reactions):
                continue
            raise ValueError(f"{s} in {one.what}, {one.expression}, {_why(s, rates, one.is_force)}")


def _every(m: Mechanics) -> list[_Stated]:
    found = []
    for mass in m.masses:
        found.append(_Stated(f"the position x of mass {mass.name}", mass.x))
        found.append(_Stated(f"the position y of mass {mass.name}", mass.y))
    found.append(_Stated("the potential", m.potential))
    found += [_Stated(f"the couple on {c}", e, True) for c, e in m.couples.items()]
    for mass, force in m.forces.items():
        for axis, e in zip("xy", force, strict=True):
            found.append(_Stated(f"the force {axis} on mass {mass.name}", e, True))
    reactions = tuple(r for mass in m.masses for r in mass.reaction)
    found += [_Stated(f"observed {name}", e, True, reactions) for name, e in m.observed.items()]
    if m.constraint is not None:
        at = (Parameter("x"), Parameter("y"))  # like any parameter
        found.append(_Stated("the equation of the constraint", m.constraint.equation(*at)))
        found.append(_Stated("the coordinate of the constraint", m.constraint.coordinate(*at)))
        if m.constraint.distance is not None:
            found.append(_Stated("the distance from the constraint", m.constraint.distance(*at)))
    return found


def _symbols(one: _Stated) -> list[Symbol]:
    """Its symbols in their order; ValueError for what is no finite real scalar."""
    try:
        found = sympy.sympify(one.expression)
    except sympy.SympifyError:
        found = None
    if not isinstance(found, Expr) or found.has(*_INFINITE):
        raise ValueError(
            f"{one.what} is {one.expression!r}: give one finite real expression of coordinates "
            "and parameters"
        )
    for part in sympy.preorder_traversal(found):
        if not isinstance(part, _PLAIN) and type(part).__name__ not in _FUNCTIONS:
            raise ValueError(
                f"{part} in {one.what} has no equations that could be written down: use powers, "
                f"sqrt, {', '.join(_FUNCTIONS)}"
            )
    return sorted(found.free_symbols, key=str)


def _why(s: Symbol, rates: set[Parameter], is_force: bool) -> str:
    """What is wrong with a symbol, and the remedy."""
    if isinstance(s, Coordinate):
        return "is no coordinate of this statement: list it in coordinates"
    if isinstance(s, Rate) and is_force:
        return "is the rate of no coordinate of this statement: list that in coordinates"
    if s in rates or isinstance(s, Rate):
        return "is a rate, and neither positions nor a potential have one: use couples or forces"
    if isinstance(s, Reaction):
        return "is a reaction, which only `observed` may contain, of masses that are listed"
    if isinstance(s, Input):
        return "is an input, and neither positions nor a potential have one: use couples or forces"
    if is_force:
        return (
            "is no symbol of this system: make it an input_(NAME), which the host gives (of time, "
            "too), a parameter(NAME), a shape, or one of the declared coordinates"
        )
    return (
        "is no symbol of this system: make it a parameter(NAME), a shape(NAME), whose motion an "
        "input_ of the FMU drives, or one of the declared coordinates"
    )


# -- what holds in Cartesian coordinates, too ------------------------------------------------------
def _cartesian(m: Mechanics) -> None:
    """Raise ValueError for what the form with a multiplier would leave out or take otherwise."""
    (c,) = m.coordinates
    own = {c, c.rate}
    lost = [f"the couple on {c}, {e}," for e in m.couples.values() if e != 0]
    lost += [_shown(drag) + f" of {c}" for drag in m.damping if drag.of == c]
    lost += [f"the potential, {m.potential},"] if m.potential != 0 else []
    for mass, force in m.forces.items():
        for axis, e in zip("xy", force, strict=True):
            if not own.isdisjoint(sympy.sympify(e).free_symbols):
                lost.append(f"the force {axis} on mass {mass.name}, {e},")
    lost += [f"shape {s}" for s in m.shapes]
    lost += ["linear_about"] if m.linear_about is not None else []
    at = [e for mass in m.masses for e in (mass.x, mass.y)]
    if c.is_angle and all(is_periodic(e, c) for e in at):  # positions do not tell its turns
        for name, e in m.observed.items():
            if not is_periodic(sympy.sympify(e), c):
                lost.append(f"observed {name}, {e}, which counts turns,")
    if lost:
        raise ValueError(
            f"{lost[0]} has no part in the Cartesian form of a constraint, which knows inputs, "
            "parameters and drag on the mass on a curve that keeps its shape: leave the constraint "
            "out"
        )


# -- how they are called -------------------------------------------------------------------------
def _names(m: Mechanics) -> None:
    stated = [("coordinate", c.name) for c in m.coordinates]
    stated += [("mass", mass.name) for mass in m.masses]
    stated += [("frame", m.frame)] if m.frame is not None else []
    stated += [("damping", drag.name) for drag in m.damping]
    stated += [("shape", s.name) for s in m.shapes]
    stated += [("observed", name) for name in m.observed]
    stated += [("parameter", name) for name in m.parameters] + [("input", n) for n in m.inputs]
    for what, name in stated:
        if not is_variable_name(name):
            raise ValueError(f"{what} {name!r} is no name of a variable: use {RULE}")
    taken = Counter([*m.parameters, *m.inputs, *m.outputs])
    for name, count in taken.items():
        if count > 1 or name in _RESERVED:
            raise ValueError(
                f"{name} would stand for two things: a mass or frame NAME has the outputs "
                "NAME.x, .y, .vx and .vy; call a coordinate or parameter otherwise, as in "
                f"{name.partition('.')[0]}.u, and no two masses alike"
            )
