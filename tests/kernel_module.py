"""The derived kernel of a system, interpreted."""

from __future__ import annotations

from types import ModuleType
from typing import Any

from curvebound.mechanics.derived import Derived

__all__ = ["kernel_module"]


def kernel_module(derived: Derived) -> Any:
    """The module that its FMU would compile."""
    module = ModuleType("derived_kernel")
    exec(compile(derived.kernel, "derived kernel", "exec"), module.__dict__)
    return module
