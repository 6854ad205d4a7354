"""The variables of an FMU that its physics implies, completed by what fmu.py says of them."""

from __future__ import annotations

import difflib

from ..errors import CurveboundError
from ..mechanics.derived import Derived, Implied
from ..units import per_second
from .common import ENERGY, GRAVITY, SOLVER
from .declaration import CHOICE, INPUT, OUTPUT, PARAMETER, Enumeration, Variable

__all__ = ["complete_variables"]

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


def complete_variables(declared: tuple[Variable, ...], derived: Derived) -> tuple[Variable, ...]:
    """All variables of a system, in the order of its kernel: those declared, where they are.

    Raises CurveboundError for a declared variable that the system has not.
    """
    own = {v.name: v for v in declared}
    common = {v.name for v in (*GRAVITY, *SOLVER, *ENERGY)}
    implied = [_variable(v, own, derived) for v in derived.variables if v.name != "energy"]
    known = {v.name for v in implied} | common
    for name in own:
        if name not in known:
            near = difflib.get_close_matches(name, sorted(known), 3, 0.4) or sorted(known)
            raise CurveboundError(
                f"fmu.py declares {name}, which mechanics.py does not have: it has "
                f"{', '.join(near)}"
            )

    def of(kind: str) -> list[Variable]:
        return [v for v in implied if v.kind == kind]

    def shared(variables: tuple[Variable, ...]) -> list[Variable]:
        return [own.get(v.name, v) for v in variables]

    outputs = [v.name for v in derived.variables if v.kind == "output"]
    at = outputs.index("energy")
    found = of(OUTPUT)
    found[at:at] = shared(ENERGY)
    return (*shared(GRAVITY), *of(PARAMETER), *of(CHOICE), *shared(SOLVER), *of(INPUT), *found)


def _variable(v: Implied, own: dict[str, Variable], derived: Derived) -> Variable:
    if v.name in own:
        return own[v.name]
    enumeration = _ENUMERATIONS.get(v.name)
    unit = v.unit
    if v.of in own:
        unit = per_second(own[v.of].unit, v.per_second) if v.per_second else own[v.of].unit
    return Variable(
        _KINDS[v.kind], v.name, unit, v.start, v.description, v.minimum, v.above, type=enumeration
    )
