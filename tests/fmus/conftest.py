"""Equations of both systems, derived by sympy from their Lagrangians, to hold the models against.

Everything is derived in the world frame, with the motion of the frame and the coefficient of the
parabola as functions of time, and evaluated by mpmath in 60 digits: none of the manipulations in
the models is repeated here.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import Any

import mpmath
import pytest
import sympy as sp

from curvebound import checks
from curvebound.study.stability.ranges import draw
from curvebound.study.stability.sample import Sampled, SampleSettings, run_points

DIGITS = 60

BEAD = {
    "gravity.x": 0.0,
    "gravity.y": -9.81,
    "wire.radius": 1.0,
    "bead.mass": 1.0,
    "bead.damping": 0.0,
    "bead.angle_start": 1.5707963267948966,
    "bead.angular_velocity_start": 0.0,
    "constraint.stiffness": 100.0,
    "constraint.damping": 20.0,
}

PARABOLA = {
    "gravity.x": 0.0,
    "gravity.y": -9.81,
    "parabola.coefficient_start": 0.5,
    "parabola.coefficient_rate_start": 0.0,
    "slider.mass": 1.0,
    "pendulum.mass": 1.0,
    "pendulum.length": 1.0,
    "slider.damping": 0.0,
    "pendulum.damping": 0.0,
    "slider.u_start": 0.5,
    "slider.u_rate_start": 0.0,
    "pendulum.angle_start": 0.5,
    "pendulum.angular_velocity_start": 0.0,
}


class Mechanics:
    """Equations of motion and energy of a Lagrangian with prescribed functions of time.

    q: generalised coordinates; prescribed: functions of time whose zeroth to second derivatives
    are data; parameters: constants. Functions of time are replaced by plain symbols.
    """

    def __init__(
        self,
        lagrangian: Any,
        energy: Any,
        forces: Sequence[Any],
        q: Sequence[Any],
        prescribed: Sequence[Any],
        parameters: Sequence[Any],
        t: Any,
    ) -> None:
        second = [c.diff(t, 2) for c in q]
        equations = [
            lagrangian.diff(c.diff(t)).diff(t) - lagrangian.diff(c) - force
            for c, force in zip(q, forces, strict=True)
        ]
        equations = [sp.expand(e.doit()) for e in equations]
        mass = sp.Matrix([[e.coeff(a) for a in second] for e in equations])
        rest = sp.Matrix([-e.subs(dict.fromkeys(second, 0)) for e in equations])
        names: list[Any] = []
        swap: dict[Any, Any] = {}
        for order in (2, 1, 0):
            for f in [*q, *prescribed]:
                name = sp.Symbol(f"{f.func.__name__}_{order}")
                names.append(name)
                swap[f.diff(t, order)] = name
        arguments = [*names, *parameters]
        self.names = [str(a) for a in arguments]
        self.q = [f.func.__name__ for f in q]

        def compiled(expression: Any) -> Callable[..., Any]:
            return sp.lambdify(arguments, expression.xreplace(swap), "mpmath")

        self.mass = compiled(mass)
        self.rest = compiled(rest)
        self.energy = compiled(energy)
        self.energy_rate = compiled(energy.diff(t).doit())

    def arguments(self, values: dict[str, Any]) -> list[Any]:
        return [mpmath.mpf(values.get(name, 0.0)) for name in self.names]

    def acceleration(self, values: dict[str, Any]) -> list[Any]:
        """q'' with `values` by name: q, rates and data (`u_0`, `u_1`, `X_2`, `m1`, ...)."""
        with mpmath.workdps(DIGITS):
            arguments = self.arguments(values)
            return list(mpmath.lu_solve(self.mass(*arguments), self.rest(*arguments)))

    def with_acceleration(self, values: dict[str, Any]) -> dict[str, Any]:
        """`values` completed by q''."""
        found = self.acceleration(values)
        return {**values, **{f"{n}_2": a for n, a in zip(self.q, found, strict=True)}}

    def derivatives(self, values: dict[str, Any]) -> list[list[Any]]:
        """Rows dq''_i / d(q, q'), by differences with more digits than they lose."""
        rows: list[list[Any]] = [[] for _ in self.q]
        with mpmath.workdps(2 * DIGITS):
            step = mpmath.mpf(10) ** -30
            for order in (0, 1):
                for n in self.q:
                    name = f"{n}_{order}"
                    ends = []
                    for sign in (1, -1):
                        moved = {**values, name: mpmath.mpf(values[name]) + sign * step}
                        arguments = self.arguments(moved)
                        ends.append(mpmath.lu_solve(self.mass(*arguments), self.rest(*arguments)))
                    for i, row in enumerate(rows):
                        row.append((ends[0][i] - ends[1][i]) / (2 * step))
        return rows


@pytest.fixture(scope="session")
def bead_mechanics() -> Mechanics:
    t = sp.Symbol("t")
    m, r, d, gx, gy, fx, fy = parameters = sp.symbols("m r d gx gy fx fy")
    th, X, Y = (sp.Function(n)(t) for n in ("th", "X", "Y"))
    relative = sp.Matrix([r * sp.sin(th), -r * sp.cos(th)])
    position = relative + sp.Matrix([X, Y])
    velocity = position.diff(t)
    kinetic = m * velocity.dot(velocity) / 2
    potential = -m * (gx * position[0] + gy * position[1])
    force = sp.Matrix([fx, fy]) - d * relative.diff(t)
    return Mechanics(
        kinetic - potential,
        kinetic + potential,
        [force.dot(position.diff(th))],
        [th],
        [X, Y],
        parameters,
        t,
    )


def parabola_parts() -> tuple[Any, ...]:
    """Symbols, kinetic and potential energy and generalised forces of the pendulum."""
    t = sp.Symbol("t")
    parameters = sp.symbols("m1 m2 r c1 c2 gx gy f1x f1y f2x f2y")
    m1, m2, r, c1, c2, gx, gy, f1x, f1y, f2x, f2y = parameters
    u, th, X, Y, a = (sp.Function(n)(t) for n in ("u", "th", "X", "Y", "a"))
    slider = sp.Matrix([X + u, Y + a * u**2])
    bob = slider + sp.Matrix([r * sp.sin(th), -r * sp.cos(th)])
    v1, v2 = slider.diff(t), bob.diff(t)
    kinetic = (m1 * v1.dot(v1) + m2 * v2.dot(v2)) / 2
    potential = -m1 * (gx * slider[0] + gy * slider[1]) - m2 * (gx * bob[0] + gy * bob[1])
    # the friction acts along the parabola, on the speed along it
    tangent = sp.Matrix([1, 2 * a * u])
    friction = -c1 * u.diff(t) * tangent
    forces = []
    for c in (u, th):
        force = sp.Matrix([f1x, f1y]).dot(slider.diff(c)) + sp.Matrix([f2x, f2y]).dot(bob.diff(c))
        forces.append(force + friction.dot(slider.diff(c)))
    forces[1] -= c2 * th.diff(t)
    return t, parameters, (u, th), (X, Y, a), kinetic, potential, forces


@pytest.fixture(scope="session")
def parabola_mechanics() -> Mechanics:
    t, parameters, q, prescribed, kinetic, potential, forces = parabola_parts()
    return Mechanics(kinetic - potential, kinetic + potential, forces, q, prescribed, parameters, t)


@pytest.fixture(scope="session")
def linear_mechanics() -> Mechanics:
    """The part of second order of the same Lagrangian, of first order of the same forces."""
    t, parameters, q, prescribed, kinetic, potential, forces = parabola_parts()
    size = sp.Symbol("size")
    small = {c: sp.Function(c.func.__name__ + "s")(t) for c in q}

    def order(expression: Any, n: int) -> Any:
        shrunk = expression.subs({c: size * s for c, s in small.items()}).doit()
        for k in range(n):
            shrunk = shrunk.diff(size) / (k + 1)
        return shrunk.subs(size, 0).subs({s: c for c, s in small.items()}).doit()

    lagrangian = sum(order(kinetic - potential, n) for n in range(3))
    linear_forces = [order(f, 0) + order(f, 1) for f in forces]
    # Relative to the frame: frame and shape at rest, quadratic and linear terms
    still = {f.diff(t): 0 for f in prescribed} | {prescribed[0]: 0, prescribed[1]: 0}
    kinetic_still = order(kinetic.subs(still), 2)
    potential_still = order(potential.subs({prescribed[0]: 0, prescribed[1]: 0}), 1) + order(
        potential.subs({prescribed[0]: 0, prescribed[1]: 0}), 2
    )
    return Mechanics(
        lagrangian,
        kinetic_still + potential_still,
        linear_forces,
        q,
        prescribed,
        parameters,
        t,
    )


def outputs_of(model: Any) -> dict[str, float]:
    values = [float("nan")] * len(model.OUTPUTS)
    for group in sorted(set(model.OUTPUTS.values())):
        model.observe(group, values, 0)
    return dict(zip(model.OUTPUTS, values, strict=True))


@pytest.fixture(scope="session")
def outputs() -> Callable[[Any], dict[str, float]]:
    """All outputs of a model by name."""
    return outputs_of


@pytest.fixture
def sampled_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Checks run their random points in this process: they start none for a handful."""

    def run_sample(settings: SampleSettings, count: int, seed: int) -> list[Sampled]:
        return run_points(settings, draw(settings.system, count, seed))

    monkeypatch.setattr(checks, "run_sample", run_sample)


@pytest.fixture
def rng() -> random.Random:
    return random.Random(20240611)


@pytest.fixture(scope="session")
def bead_defaults() -> dict[str, float]:
    return dict(BEAD)


@pytest.fixture(scope="session")
def parabola_defaults() -> dict[str, float]:
    return dict(PARABOLA)
