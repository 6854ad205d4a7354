"""The classical fourth-order Runge-Kutta method (Kutta 1901)."""

from __future__ import annotations

from .base import Model
from .fixed_step import FixedStep

__all__ = ["RK4"]


def steps(model: Model, h: float, count: int) -> None:
    """Make `count` steps of h seconds from the communication point on."""
    # power is asked for where the accelerations were: a model whose inputs rise moves once
    work = 0.0
    half = 0.5 * h
    sixth = h / 6.0
    rises = model.rises
    works = model.works or rises
    # of the time at which the equations are asked: there is none since a move
    each = 0.0 if rises else h
    settles = model.settles
    q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
    for i in range(count):
        t = i * each
        model.acceleration(t, q0, q1, v0, v1)
        a0 = model.a0
        a1 = model.a1
        if works:
            work = model.power(t, q0, q1, v0, v1, a0, a1)
        vb0 = v0 + half * a0
        vb1 = v1 + half * a1
        qb0 = q0 + half * v0
        qb1 = q1 + half * v1
        if rises:
            model.move(i * h + half)
        model.acceleration(t + 0.5 * each, qb0, qb1, vb0, vb1)
        b0 = model.a0
        b1 = model.a1
        if works:
            work += 2.0 * model.power(t + 0.5 * each, qb0, qb1, vb0, vb1, b0, b1)
        vc0 = v0 + half * b0
        vc1 = v1 + half * b1
        qc0 = q0 + half * vb0
        qc1 = q1 + half * vb1
        model.acceleration(t + 0.5 * each, qc0, qc1, vc0, vc1)
        c0 = model.a0
        c1 = model.a1
        if works:
            work += 2.0 * model.power(t + 0.5 * each, qc0, qc1, vc0, vc1, c0, c1)
        vd0 = v0 + h * c0
        vd1 = v1 + h * c1
        qd0 = q0 + h * vc0
        qd1 = q1 + h * vc1
        if rises:
            model.move(i * h + h)
        model.acceleration(t + each, qd0, qd1, vd0, vd1)
        d0 = model.a0
        d1 = model.a1
        if works:
            work += model.power(t + each, qd0, qd1, vd0, vd1, d0, d1)
            model.work += sixth * work
        q0 += sixth * (v0 + 2.0 * (vb0 + vc0) + vd0)
        q1 += sixth * (v1 + 2.0 * (vb1 + vc1) + vd1)
        v0 += sixth * (a0 + 2.0 * (b0 + c0) + d0)
        v1 += sixth * (a1 + 2.0 * (b1 + c1) + d1)
        if settles:
            model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1
            model.settle(h)
            q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
    model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1


class RK4(FixedStep):
    """Four evaluations per step, order 4, explicit."""

    ORDER = 4
    MOVES = True

    def __init__(self) -> None:
        super().__init__()
        self.each = 4

    def make(self, model: Model, h: float, count: int) -> None:
        steps(model, h, count)
