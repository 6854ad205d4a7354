"""From what stands on the blackboard to a model: see statement.py for the words.

They are imported when first used: who only reads what was derived needs no sympy.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .statement import (
        Constraint,
        Mechanics,
        angle,
        drag,
        input_,
        length,
        mass,
        parameter,
        shape,
    )

__all__ = [
    "Constraint",
    "Mechanics",
    "angle",
    "drag",
    "input_",
    "length",
    "mass",
    "parameter",
    "shape",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from . import statement

    return getattr(statement, name)
