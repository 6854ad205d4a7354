"""The equations of an FMU, from the statement that it carries.

resources/mechanics.py is the statement of the system's folder, resources/reference.py what else
is known of it, both optional: EQUATIONS, a class, of a system without mechanics (a control law);
CLOSED_FORM and CLOSED_FORM_NAME, see base.ClosedForm; MAIN, see base.System.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from ....errors import CurveboundError
from ....mechanics.derive import derive_text
from ....mechanics.derived import Derived
from .base import Equations, System
from .mechanical import Hamilton, Mechanical
from .propagator import propagator

if TYPE_CHECKING:
    from ....cosim.fmu import Fmu

__all__ = ["stated_in", "system_of"]

_known: dict[str, System] = {}


def system_of(fmu: Fmu) -> System:
    """The equations of an FMU.

    Raises CurveboundError for one that carries neither a statement nor a reference.
    """
    if fmu.guid not in _known:
        _known[fmu.guid] = _system(fmu)
    return _known[fmu.guid]


def _system(fmu: Fmu) -> System:
    texts = stated_in(fmu)
    known: dict[str, Any] = {"__name__": f"reference_of_{fmu.model_name}"}
    if "reference" in texts:
        where = f"{fmu.path.name}/resources/reference.py"
        exec(compile(texts["reference"], where, "exec"), known)
    if "mechanics" not in texts:
        if "EQUATIONS" not in known:
            raise CurveboundError(
                f"There is no reference for the FMU {fmu.model_name}: it carries no mechanics.py "
                "(the statement of a system) and no reference.py that defines EQUATIONS."
            )
        return System(fmu.model_name, equations=known["EQUATIONS"])
    where = f"{fmu.path.name}/resources/mechanics.py"
    derived = derive_text(texts["mechanics"], fmu.model_name, where)
    return _mechanical(fmu, derived, known)


def stated_in(fmu: Fmu) -> dict[str, str]:
    """The texts in the FMU that its equations follow from: of "mechanics" and "reference"."""
    with zipfile.ZipFile(fmu.path) as archive:
        names = set(archive.namelist())
        return {
            name: archive.read(f"resources/{name}.py").decode()
            for name in ("mechanics", "reference")
            if f"resources/{name}.py" in names
        }


def _mechanical(fmu: Fmu, derived: Derived, known: Mapping[str, Any]) -> System:
    fidelities = _items(fmu, "model.fidelity") if derived.has_linear else []
    structures: tuple[Mapping[str, str], ...] = ({},)
    if fidelities:
        linear, full = ({"model.fidelity": item} for item in fidelities)
        structures = (full, linear)
    if derived.has_constraint:
        cartesian, minimal = _items(fmu, "model.formulation")
        held = reversed(_items(fmu, "constraint.stabilization"))
        structures = (
            {"model.formulation": minimal},
            *({"model.formulation": cartesian, "constraint.stabilization": item} for item in held),
        )
    closed = known.get("CLOSED_FORM")
    name = str(known.get("CLOSED_FORM_NAME", ""))
    if closed is None and derived.has_linear:
        closed, name = propagator, "matrix exponential, 30 digits"
    return System(
        fmu.model_name,
        equations=partial(_equations, derived, fidelities),
        witness=Hamilton,
        derived=derived,
        structures=structures,
        approximate=tuple(("model.fidelity", item) for item in fidelities[:1]),
        main=tuple(known.get("MAIN", derived.coordinates)),
        closed_form=closed,
        closed_form_name=name,
        exact_with={"model.fidelity": fidelities[0]} if fidelities else None,
    )


def _equations(derived: Derived, fidelities: list[str], parameters: Mapping[str, Any]) -> Equations:
    linear = bool(fidelities) and parameters["model.fidelity"] == fidelities[0]
    return Mechanical(parameters, derived, linear=linear)


def _items(fmu: Fmu, name: str) -> list[str]:
    """The items of an enumeration, in the order of their numbers."""
    items = fmu.variables[name].items or {}
    return sorted(items, key=lambda item: items[item])
