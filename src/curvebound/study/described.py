"""What a function of time is made of, as text: two that may differ anywhere read differently."""

from __future__ import annotations

import pickle
import uuid
from collections.abc import Mapping
from types import CodeType, FunctionType, ModuleType

__all__ = ["described"]


def described(value: object, above: tuple[object, ...] = ()) -> str:
    """The code of a function and all values in it, those of the functions that it calls included.

    What cannot be seen through is like nothing else, not even itself at another time.
    above: the functions and objects around, for those that know each other.
    """
    if any(value is one for one in above):
        return "above"
    inside = (*above, value)
    if isinstance(value, bool | int | float | str | bytes | type(None)):
        return repr(value)
    if isinstance(value, list | tuple):
        return f"[{' '.join(described(v, inside) for v in value)}]"
    if isinstance(value, Mapping):
        return described([pair for item in value.items() for pair in item], above)
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, CodeType):
        return (
            f"{value.co_code.hex()} {' '.join(value.co_names)} {described(value.co_consts, above)}"
        )
    if isinstance(value, FunctionType):
        code = value.__code__
        held = [cell.cell_contents for cell in value.__closure__ or ()]
        held += [value.__globals__[name] for name in code.co_names if name in value.__globals__]
        held += [code, value.__defaults__, value.__kwdefaults__]
        return described(held, inside)
    try:
        call = vars(type(value)).get("__call__")
        if isinstance(call, FunctionType):
            return described([call, vars(value)], inside)
        return pickle.dumps(value).hex()
    except Exception:  # whatever a foreign object raises
        return uuid.uuid4().hex
