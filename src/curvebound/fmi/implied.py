"""The variables of an FMU that its physics implies, completed by what fmu.py says of them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from ..errors import CurveboundError, nearest
from ..mechanics.derived import Derived, Implied
from ..units import exponents, per_second
from .common import ENERGY, GRAVITY, SOLVER
from .declaration import CHOICE, INPUT, OUTPUT, PARAMETER, Enumeration, Variable
from .declared import HOW

__all__ = ["complete_variables", "left_open"]

_KINDS = {"parameter": PARAMETER, "choice": CHOICE, "input": INPUT, "output": OUTPUT}
_ENUMERATIONS = {
    "model.formulation": Enumeration(
        "Formulation",
        "coordinates in which the equations of motion are integrated",
        (
            ("lagrange_multiplier", "Cartesian position and velocity with a Lagrange multiplier"),
            ("coordinate", "the generalised coordinate"),
        ),
    ),
    "constraint.stabilization": Enumeration(
        "Stabilization",
        "what keeps the Cartesian position on the curve",
        (
            ("none", "nothing: the constraint holds on acceleration level only and drifts"),
            ("baumgarte", "feedback of the drift and its rate (Baumgarte 1972)"),
            ("projection", "projection of position and velocity after each internal step"),
        ),
    ),
    "model.fidelity": Enumeration(
        "Fidelity",
        "terms of the Lagrangian that are kept",
        (("linear", "the quadratic part about rest"), ("nonlinear", "all terms")),
    ),
}


def complete_variables(
    declared: tuple[Variable, ...], derived: Derived, where: str | Path = "fmu.py"
) -> tuple[Variable, ...]:
    """All variables of a system, in the order of its kernel: those declared, where they are.

    What is declared keeps the statement's domain unless it narrows it. where: the file that
    declares, for messages. Raises CurveboundError for a declared variable that the system has not,
    or has as another kind or quantity.
    """
    own = {v.name: v for v in declared}
    stated = [v for v in derived.variables if v.name != "energy"]
    common = (*GRAVITY, *SOLVER, *ENERGY)
    kinds = {v.name: _KINDS[v.kind] for v in stated} | {v.name: v.kind for v in common}
    for name, v in own.items():
        if name not in kinds:
            raise CurveboundError(
                f"{where} declares {name}, which mechanics.py does not use; "
                + nearest(name, sorted(kinds))
            )
        if v.kind != kinds[name]:
            raise CurveboundError(
                f"{where} declares {name} as {_a(v.kind)}, but it is {_a(kinds[name])}: write "
                + HOW[kinds[name]].replace("name", repr(name), 1)
            )
    for v in common:
        if v.name in own and own[v.name].unit != v.unit:
            _same(own[v.name], (v.unit,), v.unit, where)
    units = _units(stated, own, derived, where)
    implied = [_variable(v, own, units) for v in stated]

    def of(kind: str) -> list[Variable]:
        return [v for v in implied if v.kind == kind]

    def shared(variables: tuple[Variable, ...]) -> list[Variable]:
        return [_within(own[v.name], v) if v.name in own else v for v in variables]

    outputs = [v.name for v in derived.variables if v.kind == "output"]
    at = outputs.index("energy")
    found = of(OUTPUT)
    found[at:at] = shared(ENERGY)
    return (*shared(GRAVITY), *of(PARAMETER), *of(CHOICE), *shared(SOLVER), *of(INPUT), *found)


def left_open(declared: Iterable[Variable], derived: Derived) -> list[str]:
    """The parameters and inputs of which neither statement nor declaration says what they are.

    They have the unit 1 and their names as descriptions; parameters start at 1.
    """
    own = {v.name for v in declared}
    families = {v.of or v.name for v in derived.variables if v.name in own}
    return [
        v.name
        for v in derived.variables
        if v.kind in ("parameter", "input")
        and not v.of
        and v.name not in families
        and (v.description == v.name or v.name in _of_shapes(derived))
    ]


def _of_shapes(derived: Derived) -> set[str]:
    return {f"{name}_start" for name in derived.shapes}


def _units(
    stated: list[Implied], own: dict[str, Variable], derived: Derived, where: str | Path
) -> dict[str, str]:
    """The units of what is declared, by what the unit of a variable and its rates follows from.

    Those are CurveboundErrors where the statement knows another one, or two of them contradict.
    """
    roots = {v.name: v for v in stated}
    unknown = {*_of_shapes(derived), "constraint.multiplier"}
    lengths = [n for n, turns in zip(derived.coordinates, derived.angles, strict=True) if not turns]
    units: dict[str, str] = {}
    firsts: dict[str, Variable] = {}
    for v in stated:
        if v.name not in own or v.kind == "choice":
            continue
        given, root = own[v.name], roots[v.of or v.name]
        if root.name not in unknown and root.description != root.name:
            allowed = [v.unit]
            if root.name in (f"{name}_start" for name in lengths):
                # a curve's parameter may be a mere number
                allowed.append(per_second("1", v.per_second))
            _same(given, allowed, v.unit, where)
        unit = per_second(given.unit, -v.per_second) if v.per_second else given.unit
        first = firsts.setdefault(root.name, given)
        if exponents(units.setdefault(root.name, unit)) != exponents(unit):
            raise CurveboundError(
                f"{where} declares {first.name} in {first.unit!r} and {given.name} in "
                f"{given.unit!r}, which do not go together: one follows from the other by time"
            )
    return units


def _same(given: Variable, allowed: Iterable[str], unit: str, where: str | Path) -> None:
    if given.type is None and exponents(given.unit) not in map(exponents, allowed):
        raise CurveboundError(
            f"{where} declares {given.name} in {given.unit!r}, but by mechanics.py it is in "
            f"{unit!r}: declare that unit, or state it otherwise there"
        )


def _within(given: Variable, v: Implied | Variable) -> Variable:
    """What is declared, in the domain that the statement gives it, or a narrower one."""
    if v.minimum is None:
        return given
    own = -math.inf if given.minimum is None else given.minimum
    if (own, given.above) >= (v.minimum, v.above):
        return given
    return given._replace(minimum=v.minimum, above=v.above)


def _a(kind: str) -> str:
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def _variable(v: Implied, own: dict[str, Variable], units: dict[str, str]) -> Variable:
    if v.name in own:
        return _within(own[v.name], v)
    unit = v.unit
    if (v.of or v.name) in units:
        unit = units[v.of or v.name]
        unit = per_second(unit, v.per_second) if v.per_second else unit
    return Variable(
        _KINDS[v.kind],
        v.name,
        unit,
        v.start,
        v.description,
        v.minimum,
        v.above,
        type=_ENUMERATIONS.get(v.name),
    )
