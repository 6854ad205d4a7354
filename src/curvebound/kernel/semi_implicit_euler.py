"""The semi-implicit (symplectic) Euler method (Hairer, Lubich, Wanner 2006, eq. I.1.9)."""

from __future__ import annotations

from .base import Model
from .fixed_step import FixedStep

__all__ = ["SemiImplicitEuler"]


class SemiImplicitEuler(FixedStep):
    """One evaluation per step, order 1: the new velocity moves the coordinates.

    Symplectic where the acceleration depends on q alone; with a velocity in it (damping, curved
    constraints) the old velocity is used, so that the method stays explicit.
    """

    ORDER = 1

    def make(self, model: Model, h: float, count: int) -> None:
        works = model.works
        settles = model.settles
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        for i in range(count):
            t = i * h
            model.acceleration(t, q0, q1, v0, v1)
            a0 = model.a0
            a1 = model.a1
            if works:
                model.work += h * model.power(t, q0, q1, v0, v1, a0, a1)
            v0 += h * a0
            v1 += h * a1
            q0 += h * v0
            q1 += h * v1
            if settles:
                model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1
                model.settle(h)
                q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1
