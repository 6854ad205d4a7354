"""How variables may be called: FMI's structured naming, without arrays and quotes."""

from __future__ import annotations

import re
from typing import Any, Final

__all__ = ["RULE", "is_variable_name"]

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*")

#: the rule in words, behind `use`
RULE: Final = (
    "letters, digits and underscores, no digit first, and full stops between the parts, as in "
    "body.u_left"
)


def is_variable_name(name: Any) -> bool:
    """Whether a variable of an FMU may be called that."""
    return isinstance(name, str) and _NAME.fullmatch(name) is not None
