"""The macro steps: how components advance from one communication point to the next.

With H the macro step, and each FMU integrating its own part without error while its inputs are
held, the error of the whole is of the order that `scene_parts.ALGORITHMS` states. Direct
feedthrough costs no order in any of them: at a communication point all outputs and inputs are
made consistent before anything steps.

Sources: Kuebler and Schiehlen, "Two methods of simulator coupling", Math. Comput. Model. Dyn.
Syst. 6 (2000) 93 (Jacobi and Gauss-Seidel); Busch, "Continuous approximation techniques for
co-simulation methods", Z. Angew. Math. Mech. 96 (2016) 1061 (their orders with held inputs);
Strang, "On the construction and comparison of difference schemes", SIAM J. Numer. Anal. 5 (1968)
506 (symmetric splitting); Runge, Math. Ann. 46 (1895) 167 (midpoint).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from .schedule import TRIAL, Clock, Schedule

__all__ = ["Advance", "advance_of"]

Advance = Callable[[float, float], None]
"""advance(t, H): from a consistent communication point t to t + H, outputs of the states read."""


def advance_of(schedule: Schedule) -> Advance:
    """The macro step of the scene's algorithm; made once for a schedule."""
    if schedule.advance is None:
        schedule.advance = _MACRO_STEPS[schedule.system.scene.algorithm](schedule)
    return schedule.advance


def _sweep(schedule: Schedule, *, passing_on: bool) -> Advance:
    """Every component once over the whole step, order 1.

    Jacobi: all from the values of t. Gauss-Seidel: one after the other, each with the outputs that
    the components before it in the circle have reached at t + H, as far as these are functions of
    their state. Outputs with direct feedthrough, and those of a component that nothing drives, keep
    their value of t: a controller acts without delay, and a sampled loop is reproduced exactly.
    """
    clock = Clock()
    calls = schedule.stepping(schedule.system.order, clock, passing_on=passing_on)
    run = schedule.run

    def advance(time: float, size: float) -> None:
        clock.set(time, size)
        run(calls)

    return advance


def _strang(schedule: Schedule) -> Advance:
    """Half a step of one group, a whole one of the other, half a one of the first: order 2.

    The step is symmetric in time, and each group moves along the exact flow of its own part while
    the other rests. Connections are evaluated anew between the parts; inputs that the scene drives
    are taken at t, t + H/2 and t + H. Where an input depends by direct feedthrough on an output of
    its own group, holding it is no exact flow and the order falls to 1.
    """
    system = schedule.system
    assert system.groups is not None
    half, whole = Clock(), Clock()
    rank = {name: i for i, name in enumerate(system.order)}
    first, second = (sorted(group, key=rank.__getitem__) for group in system.groups)
    steps_first = schedule.stepping(first, half, passing_on=False)
    steps_second = schedule.stepping(second, whole, passing_on=False)

    def advance(time: float, size: float) -> None:
        middle = time + 0.5 * size
        half.set(time, 0.5 * size)
        schedule.run(steps_first)
        schedule.evaluate(middle)
        whole.set(time, size)
        schedule.run(steps_second)
        schedule.evaluate(time + size)
        half.set(middle, 0.5 * size)
        schedule.run(steps_first)

    return advance


def _midpoint(schedule: Schedule) -> Advance:
    """The whole step with the inputs of its middle, to which half a step leads: order 2.

    The states go back in between. Inputs that follow a state by direct feedthrough belong to the
    middle like all others, so that the order holds for direct feedback too. It conserves nothing:
    weakly coupled masses are damped a little, stiffly coupled ones amplified.
    """
    half, whole = Clock(), Clock()
    order = schedule.system.order
    to_middle = schedule.stepping(order, half, passing_on=False)
    steps = schedule.stepping(order, whole, passing_on=False)

    def advance(time: float, size: float) -> None:
        saved = schedule.save(TRIAL)
        half.set(time, 0.5 * size)
        schedule.run(to_middle)
        schedule.evaluate(time + 0.5 * size)
        held = schedule.values()
        schedule.restore(saved, TRIAL)
        schedule.hold(held)
        whole.set(time, size)
        schedule.run(steps)

    return advance


_MACRO_STEPS: dict[str, Callable[[Schedule], Advance]] = {
    "gauss_seidel": partial(_sweep, passing_on=True),
    "jacobi": partial(_sweep, passing_on=False),
    "strang": _strang,
    "midpoint": _midpoint,
}
