"""The derivation of a mechanics.py from end to end."""

from __future__ import annotations

import traceback
from typing import Any

import sympy

from ..errors import CurveboundError, said
from .derivation import Derivation
from .derived import Derived, Implied
from .elements import Coordinate
from .equations import equations_source
from .kernel_source import kernel_source
from .names import Names
from .statement import Mechanics
from .statement import __all__ as WORDS

__all__ = ["derived_from"]


def derived_from(text: str, title: str, where: str) -> Derived:
    """What follows from a statement; CurveboundError for one that says too little."""
    stated = _stated(text, where)
    mechanics = stated.get("MECHANICS")
    if not isinstance(mechanics, Mechanics):
        raise CurveboundError(f"{where} does not define MECHANICS = Mechanics(...).")
    try:
        derivation = Derivation(mechanics)
        kernel = kernel_source(derivation, Names(title, derivation, stated))
        equations = equations_source(derivation)
    except ValueError as error:
        raise CurveboundError(f"{where} cannot be derived: {error}.") from error
    return Derived(
        coordinates=tuple(c.name for c in mechanics.coordinates),
        rates=tuple(c.rate.name for c in mechanics.coordinates),
        angles=tuple(c.is_angle for c in mechanics.coordinates),
        masses=tuple(m.name for m in mechanics.masses),
        shapes=tuple(s.name for s in mechanics.shapes),
        frame=mechanics.frame or "",
        damping=tuple(d.name for d in mechanics.damping),
        forces=tuple(s.name for s in derivation.external_inputs),
        has_linear=mechanics.linear_about is not None,
        has_constraint=mechanics.constraint is not None,
        variables=tuple(_variables(mechanics)),
        kernel=kernel,
        equations=equations,
    )


def _stated(text: str, where: str) -> dict[str, Any]:
    namespace: dict[str, Any] = {"__name__": "mechanics", "__file__": where}
    try:
        exec(compile(text, where, "exec"), namespace)
    except SyntaxError as error:
        place = f"{where}, line {error.lineno}"
        raise CurveboundError(f"{place}: SyntaxError: {error.msg}.") from error
    except Exception as error:  # whatever the author's own text raises
        frames = traceback.extract_tb(error.__traceback__)
        line = [frame.lineno for frame in frames if frame.filename == where][-1]
        raise CurveboundError(f"{where}, line {line}: {said(error)}{_hint(error)}.") from error
    return namespace


def _hint(error: Exception) -> str:
    """A remedy for what authors of a mechanics.py often meet, behind the message."""
    if isinstance(error, NameError):
        for module, names in (("curvebound.mechanics", WORDS), ("sympy", sympy.__all__)):
            if error.name in names:
                return f": import it, from {module} import {error.name}"
        return ": define it, or import it"
    text = str(error)
    if isinstance(error, TypeError) and ("Cannot convert expression" in text or "ufunc" in text):
        return (
            ": the functions of math and numpy take numbers, no coordinates and parameters; "
            "import them from sympy, from sympy import sin"
        )
    return ""


def _variables(m: Mechanics) -> list[Implied]:
    """Every variable of the statement; gravity, solver and energy are common to all systems."""
    known = _known(m)
    found = []
    for name in m.parameters:
        if not name.startswith("gravity."):
            found.append(known.get(name) or Implied("parameter", name, "1", 1.0, name))
    if m.constraint is not None:
        found.append(Implied("choice", "model.formulation", "", 1, "coordinates of the equations"))
        text = "what keeps the Cartesian position on the curve"
        found.append(Implied("choice", "constraint.stabilization", "", 3, text))
    if m.linear_about is not None:
        text = "terms of the Lagrangian that are kept"
        found.append(Implied("choice", "model.fidelity", "", 2, text))
    for name in m.inputs:
        found.append(known.get(name) or Implied("input", name, "1", 0.0, name))
    for name in m.outputs:
        if not name.startswith("energy."):
            found.append(known.get(name) or Implied("output", name, "N", 0.0, name))
        elif name == "energy.kinetic":
            found.append(Implied("output", "energy", "J", 0.0, "the energies, in their order"))
    return found


def _known(m: Mechanics) -> dict[str, Implied]:
    """Variables whose unit and meaning follow from what they are declared as."""
    found: list[Implied] = []

    def add(kind: str, name: str, unit: str, text: str, **more: Any) -> None:
        found.append(Implied(kind, name, unit, more.pop("start", 0.0), text, **more))

    for c in m.coordinates:
        _of_coordinate(c, add)
    for mass in m.masses:
        n = mass.name
        positive = {"start": 1.0, "minimum": 0.0, "above": True}
        add("parameter", f"{n}.mass", "kg", f"mass of the {n} (above zero)", **positive)
        for axis, way in (("x", "to the right"), ("y", "upward")):
            add("input", f"{n}.f{axis}", "N", f"external force on the {n} {way}")
            add("output", f"{n}.{axis}", "m", f"position of the {n} {way}, world frame")
            add("output", f"{n}.v{axis}", "m/s", f"velocity of the {n} {way}, world frame")
    if m.frame:
        for axis, way in (("x", "to the right"), ("y", "upward")):
            add("input", f"{m.frame}.a{axis}", "m/s2", f"acceleration of the {m.frame} {way}")
            add("output", f"{m.frame}.{axis}", "m", f"position of the {m.frame} {way}")
            add("output", f"{m.frame}.v{axis}", "m/s", f"velocity of the {m.frame} {way}")
            add("output", f"{m.frame}.f{axis}", "N", f"force on the {m.frame} {way}")
    for d in m.damping:
        unit = "N.m.s/rad" if isinstance(d.of, Coordinate) and d.of.is_angle else "N.s/m"
        whose = d.of.name if not isinstance(d.of, Coordinate) else d.of.name.partition(".")[0]
        add("parameter", d.name, unit, f"viscous damping of the {whose}", minimum=0.0)
    for s in m.shapes:
        start = f"{s.name}_start"
        add("parameter", start, "1", f"initial {s.name}", start=1.0)
        add("parameter", f"{s.rate.name}_start", "1/s", f"initial rate of {s.name}",
            of=start, per_second=1)  # fmt: skip
        text = f"second time derivative of {s.name}"
        add("input", s.acceleration.name, "1/s2", text, of=start, per_second=2)
        add("output", s.name, "1", s.name, of=start)
        add("output", s.rate.name, "1/s", f"rate of {s.name}", of=start, per_second=1)
    if m.constraint is not None:
        text = "Baumgarte feedback of the constraint"
        add("parameter", "constraint.stiffness", "1/s2", text, start=100.0, minimum=0.0)
        text = "Baumgarte feedback of the rate of the constraint"
        add("parameter", "constraint.damping", "1/s", text, start=20.0, minimum=0.0)
        text = "multiplier: the constraint force is it times the gradient of the constraint"
        add("output", "constraint.multiplier", "1", text)
        add("output", "constraint.force", "N", "constraint force, positive along the gradient")
        add("output", "constraint.drift", "m", "distance from the curve")
    text = "linear fidelity: relative difference between linear and nonlinear accelerations"
    add("output", "model.acceleration_error", "1", text)
    return {v.name: v for v in found}


def _of_coordinate(c: Coordinate, add: Any) -> None:
    start = f"{c.name}_start"
    unit = "rad" if c.is_angle else "m"
    text = f"{c.name.rpartition('.')[2]} of the {c.name.partition('.')[0]}"
    add("parameter", start, unit, f"initial {text}")
    add("parameter", f"{c.rate.name}_start", f"{unit}/s", f"initial rate of {c.name}",
        of=start, per_second=1)  # fmt: skip
    add("output", c.name, unit, text + (", continuous" if c.is_angle else ""), of=start)
    add("output", c.rate.name, f"{unit}/s", f"rate of {c.name}", of=start, per_second=1)
