"""What a page may ask for, and how it is told from what is malformed."""

from __future__ import annotations

import json
import math
from typing import Any, NamedTuple, NoReturn

__all__ = ["LONGEST", "Command", "Malformed", "parse"]

LONGEST = 65_536  # bytes of a message

_NUMBER, _TEXT, _VALUE, _SETTINGS = "a finite number", "a text", "a number", "settings by path"

#: what each command must tell
_FIELDS: dict[str, dict[str, str]] = {
    "play": {},
    "pause": {},
    "step": {},
    "reset": {},
    "original": {},
    "undo": {},
    "mark": {},
    "back": {},
    "alone": {},
    "release": {},
    "record": {},
    "speed": {"value": _NUMBER},
    "set": {"path": _TEXT, "value": _VALUE},
    "restart": {"settings": _SETTINGS},
    "beside": {"label": _TEXT, "settings": _SETTINGS},
    "variant": {"name": _TEXT},
    "pull": {"grip": _NUMBER, "x": _NUMBER, "y": _NUMBER},
}


class Malformed(ValueError):
    """A message that is no command; its text says why."""


class Command(NamedTuple):
    """name: one of those above; fields: what it tells."""

    name: str
    fields: dict[str, Any]


def parse(message: str | bytes) -> Command:
    """The command in a message; Malformed where it is none."""
    if not isinstance(message, str):
        raise Malformed("a command is a text, no binary message")
    try:
        told = json.loads(message, parse_constant=_refuse)
    except (ValueError, RecursionError) as error:
        raise Malformed(f"a command is JSON: {error}") from None
    if not isinstance(told, dict):
        raise Malformed("a command is an object with the field `do`")
    name = told.pop("do", None)
    fields = _FIELDS.get(name) if isinstance(name, str) else None
    if fields is None:
        raise Malformed(f"there is no command {name!r:.60}; there is {', '.join(_FIELDS)}")
    if told.keys() != fields.keys():
        raise Malformed(f"{name} tells {', '.join(fields) or 'nothing'}, not {sorted(told)!r:.80}")
    for field, kind in fields.items():
        if not _fits(told[field], kind):
            raise Malformed(f"{field} of {name} is {told[field]!r:.60}; give {kind}")
    return Command(str(name), told)


def _fits(value: Any, kind: str) -> bool:
    if kind == _SETTINGS:
        return isinstance(value, dict) and all(
            _is_number(one) or (isinstance(one, str) and len(one) < 200) for one in value.values()
        )
    if kind == _TEXT:
        return isinstance(value, str) and len(value) < 200
    return _is_number(value) or (kind == _VALUE and isinstance(value, bool))


def _is_number(value: Any) -> bool:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False


def _refuse(text: str) -> NoReturn:
    raise ValueError(f"{text} is no number")
