"""The explicit Euler method (Euler 1768)."""

from __future__ import annotations

from .base import Model
from .fixed_step import FixedStep

__all__ = ["ExplicitEuler"]


class ExplicitEuler(FixedStep):
    """One evaluation per step, order 1: the baseline, energy grows on every oscillation."""

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
            q0 += h * v0
            q1 += h * v1
            v0 += h * a0
            v1 += h * a1
            if settles:
                model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1
                model.settle(h)
                q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1
