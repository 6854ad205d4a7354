"""Checks of what fmu.py declares, before anything is made of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CurveboundError, nearest
from ..naming import RULE, is_variable_name
from ..units import exponents
from .declaration import (
    CHOICE,
    COUNT,
    COUNT_PARAMETER,
    INPUT,
    OUTPUT,
    PARAMETER,
    Fmu,
    Variable,
)
from .table import RATES

if TYPE_CHECKING:
    from ..kernel.base import Model

__all__ = ["HOW", "check_kernel", "check_names", "check_starts", "check_variables"]

#: how a variable of each kind is declared
HOW = {
    PARAMETER: "parameter(name, unit, start, description)",
    CHOICE: "choice(name, enumeration, start, description)",
    COUNT_PARAMETER: "count_parameter(name, start, description, at_least=...)",
    INPUT: "input_(name, unit, description)",
    OUTPUT: "output(name, unit, description)",
    COUNT: "count(name, description)",
}


def check_variables(variables: object, where: Path) -> None:
    """Raise CurveboundError unless these are variables, each once, with a unit that is one.

    variables: as the file `where` declares them.
    """
    if isinstance(variables, Variable):
        raise CurveboundError(
            f"{where} declares {variables.name} alone, which takes a comma behind it: "
            f"variables=({variables.kind}(...),)"
        )
    if not isinstance(variables, tuple | list):
        raise CurveboundError(f"{where} declares variables={variables!r}: give a tuple of them")
    for one in variables:
        if not isinstance(one, Variable):
            raise CurveboundError(
                f"{where} declares {one!r} among the variables, which is none: write "
                "parameter(...), input_(...), output(...) or one of their kind"
            )
        _check_fields(one, where)
    for name, count in Counter(v.name for v in variables).items():
        if count > 1:
            raise CurveboundError(f"{where} declares {name} {count} times: keep one of them")


def _check_fields(v: Variable, where: Path) -> None:
    given = {"name": v.name, "unit": v.unit, "description": v.description}
    wrong = [f"the {what} {x!r}" for what, x in given.items() if not isinstance(x, str)]
    if isinstance(v.start, bool) or not isinstance(v.start, int | float):
        wrong.append(f"the start {v.start!r}")
    if wrong:
        text = " and ".join(wrong)
        raise CurveboundError(
            f"{where} declares {v.name!r} with {text}: the start is a number, all else is text; "
            f"write {HOW[v.kind]}"
        )
    if not is_variable_name(v.name):
        raise CurveboundError(f"{where} declares {v.name!r}, no name of a variable: use {RULE}")
    if v.kind in (PARAMETER, INPUT, OUTPUT):
        try:
            exponents(v.unit)
        except CurveboundError as error:
            raise CurveboundError(f"{where}, unit of {v.name}: {error}") from error


def check_starts(fmu: Fmu, where: Path | str) -> None:
    """Raise CurveboundError for a start value outside its variable's domain, given at `where`."""
    for v in fmu.variables:
        least = -math.inf if v.minimum is None else v.minimum
        if not math.isfinite(v.start) or v.start < least or (v.above and v.start == least):
            domain = "finite" if v.minimum is None else f"{'above' if v.above else 'at least'} "
            domain += "" if v.minimum is None else f"{v.minimum:g}"
            raise CurveboundError(
                f"{where}: {v.name} starts at {v.start!r}, but must be {domain}: declare another "
                "start value"
            )


def check_names(fmu: Fmu, where: Path) -> None:
    """Raise CurveboundError where the declaration names a variable that the FMU has not."""
    known = {v.name for v in fmu.variables}
    outputs = [v.name for v in fmu.variables if v.kind in (OUTPUT, COUNT)]
    for name in fmu.plotted:
        if name not in outputs:
            raise CurveboundError(
                f"{where}: plotted names {name!r}, which is no output; {nearest(name, outputs)}"
            )
    driven = [v.name for v in fmu.variables if v.kind == INPUT or v.tunable]
    for name in fmu.reference_inputs:
        if name not in driven:
            raise CurveboundError(
                f"{where}: reference_inputs names {name!r}, which is no input or tunable "
                f"parameter; {nearest(name, driven)}"
            )
    for name in fmu.ranges:
        if name not in known and f"{name}.x" not in known:
            raise CurveboundError(
                f"{where}: ranges names {name!r}, which is no variable; "
                + nearest(name, sorted(known))
            )


def check_kernel(fmu: Fmu, factory: Callable[[dict[str, int]], Model], where: Path) -> None:
    """Raise CurveboundError where a kernel by hand does not have the variables that are declared.

    factory: gives the model of the choices, by number.
    """
    reals = {v.name: float(v.start) for v in fmu.variables if v.kind in (PARAMETER, INPUT)}
    whole = (CHOICE, COUNT_PARAMETER)
    choices = {v.name: int(v.start) for v in fmu.variables if v.kind in whole}
    try:
        model = factory(choices)
        model.start(reals, choices)
    except KeyError as error:
        missing = str(error.args[0])
        raise CurveboundError(
            f"kernel.py reads {missing}, which {where} does not declare; "
            + nearest(missing, sorted({*reals, *choices}))
        ) from error
    except (ValueError, ArithmeticError):
        return  # the FMU tells of such start values itself
    groups = max(model.OUTPUTS.values(), default=0) + 1
    if groups >= RATES:
        raise CurveboundError(
            f"the kernel.py of {where} has its outputs in {groups} groups: there can be "
            f"{RATES - 1}; compute more of them together"
        )
    for kind, own in ((INPUT, model.INPUTS), (OUTPUT, model.OUTPUTS)):
        declared = [v.name for v in fmu.variables if v.kind == kind]
        for a, b in zip_longest(declared, own):
            if a != b:
                raise CurveboundError(
                    f"{where} declares {a or 'no further one'} where the {kind}s of kernel.py have "
                    f"{b or 'no further one'}: declare them in its order, each once"
                )
