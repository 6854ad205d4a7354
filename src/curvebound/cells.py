"""Cells of CSV files, which a spreadsheet may open: no text in them is run as a formula."""

from __future__ import annotations

import re

__all__ = ["cell", "defused", "undefused"]

# what begins a formula, at the beginning and behind what may be taken for the separator of cells;
# those of full width are read as such too
_SIGN = r"'*[ ]*[=+\-@\uff1d\uff0b\uff0d\uff20]"
_FORMULA = re.compile(rf"(^|[;\t\r\n])({_SIGN})")
_DEFUSED = re.compile(rf"(^|[;\t\r\n])'({_SIGN})")


def cell(value: object) -> str:
    """A value as a cell: None empty, floats with every digit, text that is no number defused."""
    if value is None:
        return ""
    if isinstance(value, float):
        return repr(float(value))
    return defused(str(value))


def defused(text: str) -> str:
    """`text` with an apostrophe before what a spreadsheet would run; numbers stay as they are."""
    try:
        float(text)
    except ValueError:
        return _FORMULA.sub(r"\1'\2", text)
    return text


def undefused(text: str) -> str:
    """The text that `defused` was given."""
    return _DEFUSED.sub(r"\1\2", text)
