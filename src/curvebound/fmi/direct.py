"""What an FMU's binary calls of a compiled engine without making objects of what it passes.

Cython puts C functions of a module into its `__pyx_capi__`; native/direct.c takes these from there.
Interpreted they are not called: the engine's methods of the same names are, with lists.
"""

from __future__ import annotations

from .derivatives import DerivativeEngine

__all__: list[str] = []


def do_step(engine: DerivativeEngine, time: float, size: float) -> bool:
    """fmi2DoStep."""
    return engine.do_step(time, size)


def get_real(engine: DerivativeEngine, vr: int) -> float:
    """fmi2GetReal, of one variable."""
    return engine.real(vr)


def set_real(engine: DerivativeEngine, vr: int, value: float) -> None:
    """fmi2SetReal, of one variable."""
    engine.take_real(vr, value)


def set_slope(engine: DerivativeEngine, vr: int, order: int, value: float) -> None:
    """fmi2SetRealInputDerivatives, of one variable."""
    engine.take_slope(vr, order, value)


def get_rate(engine: DerivativeEngine, vr: int, order: int) -> float:
    """fmi2GetRealOutputDerivatives, of one variable."""
    return engine.rate(vr, order)
