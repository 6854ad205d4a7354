"""FMI 2.0 co-simulation FMUs of bodies bound to curves, and the tools to trust and use them."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .study.linear_model import linearize

__version__ = "0.1.0"
__all__ = ["linearize"]

#: date of the sources, which dates the FMUs built from them
__date__ = "2026-11-22"


def __getattr__(name: str) -> Any:
    # imported when first used: with numpy and all, and not needed for most commands
    if name != "linearize":
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from .study.linear_model import linearize

    return linearize
