"""What both fidelities of the pendulum on the parabola share: variables, inputs, frame, geometry.

A slider (mass m1) at (u, a u^2) from the vertex of the parabola and a bob (m2) at slider +
r (sin th, -cos th); q0 = u, q1 = th. Short names used in these modules:

    q = 2 a u                   slope of the parabola under the slider
    w = cos th + q sin th       parts of the tangent (1, q) across the rod and along it,
    k = sin th - q cos th       so that 1 + q^2 = w^2 + k^2
    X = X'' - gravity.x         apparent horizontal acceleration of the vertex
    G = Y'' - gravity.y + 2 a u'^2 + 4 a' u u' + a'' u^2     and vertical one, path included
"""

from __future__ import annotations

import math
from typing import ClassVar, Final

from curvebound.kernel.angles import unwind
from curvebound.kernel.base import Values
from curvebound.kernel.frame import THIRD, FramedModel

__all__ = ["ParabolaBase"]

_OUTPUTS: Final[dict[str, int]] = {
    "slider.u": 0,
    "slider.u_rate": 0,
    "pendulum.angle": 0,
    "pendulum.angular_velocity": 0,
    "slider.x": 0,
    "slider.y": 0,
    "slider.vx": 1,
    "slider.vy": 1,
    "pendulum.x": 0,
    "pendulum.y": 0,
    "pendulum.vx": 1,
    "pendulum.vy": 1,
    "parabola.x": 2,
    "parabola.y": 2,
    "parabola.vx": 2,
    "parabola.vy": 2,
    "parabola.coefficient": 2,
    "parabola.coefficient_rate": 2,
    "energy.kinetic": 3,
    "energy.potential": 3,
    "energy.total": 3,
    "energy.residual": 3,
    "constraint.normal_force": 4,
    "pendulum.tension": 4,
    "parabola.fx": 4,
    "parabola.fy": 4,
    "model.acceleration_error": 5,
}


class ParabolaBase(FramedModel):
    """Parameters, inputs, a(t), saved state and outputs of both fidelities."""

    PARAMETERS: ClassVar[tuple[str, ...]] = (
        "gravity.x",
        "gravity.y",
        "parabola.coefficient_start",
        "parabola.coefficient_rate_start",
        "slider.mass",
        "pendulum.mass",
        "pendulum.length",
        "slider.damping",
        "pendulum.damping",
        "slider.u_start",
        "slider.u_rate_start",
        "pendulum.angle_start",
        "pendulum.angular_velocity_start",
    )
    CHOICES: ClassVar[tuple[str, ...]] = ("model.fidelity",)
    INPUTS: ClassVar[tuple[str, ...]] = (
        "parabola.ax",
        "parabola.ay",
        "parabola.coefficient_acceleration",
        "slider.fx",
        "slider.fy",
        "pendulum.fx",
        "pendulum.fy",
    )
    OUTPUTS: ClassVar[dict[str, int]] = _OUTPUTS
    FEEDTHROUGH: ClassVar[tuple[int, ...]] = (4, 5)

    def __init__(self) -> None:
        super().__init__()
        self.m1: float = 1.0
        self.m2: float = 1.0
        self.mass: float = 2.0
        self.mass_ratio: float = 2.0  # (m1 + m2) / m2
        self.r: float = 1.0
        self.per_r: float = 1.0
        self.c1: float = 0.0
        self.c2: float = 0.0
        # coefficient at the communication point and its derivatives
        self.a: float = 0.0
        self.a_rate: float = 0.0
        self.a_acceleration: float = 0.0
        self.a_jerk: float = 0.0
        #: whether a changes during the communication step
        self.reshapes: bool = False
        # forces on slider and bob (N)
        self.f1x: float = 0.0
        self.f1y: float = 0.0
        self.f2x: float = 0.0
        self.f2y: float = 0.0
        #: whether there is any force or damping
        self.forced: bool = False
        #: X and G without its terms in u (m/s2)
        self.sway: float = 0.0
        self.lift: float = 0.0
        #: magnification at the start
        self.first_magnification: float = 1.0
        self.kept_a: float = 0.0
        self.kept_a_rate: float = 0.0

    def remedy(self, trouble: str) -> str:
        if trouble == "linear":
            return "set model.fidelity = 1 (linear), or "
        if trouble == "nonlinear":
            return "set model.fidelity = 2 (nonlinear), or start smaller"
        if trouble == "rounding":
            return "choose a heavier slider.mass, start lower on the parabola, or "
        return ""

    def variation(self) -> str:
        return (
            f"parabola.coefficient_rate = {self.a_rate!r} 1/(m.s) and "
            f"parabola.coefficient_acceleration = {self.a_acceleration!r} 1/(m.s2)"
        )

    def start(self, parameters: dict[str, float], choices: dict[str, int]) -> None:
        self.rest_frame(parameters)
        self.m1 = parameters["slider.mass"]
        self.m2 = parameters["pendulum.mass"]
        self.mass = self.m1 + self.m2
        self.mass_ratio = self.mass / self.m2
        self.r = parameters["pendulum.length"]
        self.per_r = 1.0 / self.r
        self.c1 = parameters["slider.damping"]
        self.c2 = parameters["pendulum.damping"]
        self.a = parameters["parabola.coefficient_start"]
        self.a_rate = parameters["parabola.coefficient_rate_start"]
        self.a_acceleration = self.a_jerk = 0.0
        self.f1x = self.f1y = self.f2x = self.f2y = 0.0
        self.turns = 0.0
        self.settles = False
        self.q0 = parameters["slider.u_start"]
        self.v0 = parameters["slider.u_rate_start"]
        self.q1 = parameters["pendulum.angle_start"]
        self.v1 = parameters["pendulum.angular_velocity_start"]
        self.q0_scale = self.r
        self.q1_scale = 1.0
        self.sway = -self.gx
        self.lift = -self.gy
        self.place()
        self.note_initial_energy()
        self.refresh()

    def place(self) -> None:
        """Bring the initial state into the form that the fidelity integrates."""

    def take_inputs(self, t: float) -> None:
        self.ax = self.inputs[0] + t * self.slopes[0]
        self.ay = self.inputs[1] + t * self.slopes[1]
        self.a_acceleration = self.inputs[2] + t * self.slopes[2]
        self.f1x = self.inputs[3] + t * self.slopes[3]
        self.f1y = self.inputs[4] + t * self.slopes[4]
        self.f2x = self.inputs[5] + t * self.slopes[5]
        self.f2y = self.inputs[6] + t * self.slopes[6]
        self.jx = self.slopes[0]
        self.jy = self.slopes[1]
        self.a_jerk = self.slopes[2]
        self.sway = self.ax - self.gx
        self.lift = self.ay - self.gy

    def refresh(self) -> None:
        self.reshapes = self.a_rate != 0.0 or self.a_acceleration != 0.0
        self.is_constant = not self.reshapes
        self.moving = self.ax != 0.0 or self.ay != 0.0 or self.vx != 0.0 or self.vy != 0.0
        self.forced = (
            self.c1 != 0.0
            or self.c2 != 0.0
            or self.f1x != 0.0
            or self.f1y != 0.0
            or self.f2x != 0.0
            or self.f2y != 0.0
        )
        self.works = self.forced or self.moving or self.reshapes

    def advance_frame(self, duration: float) -> None:
        if self.moving or self.reshapes:
            self.move_frame(duration)
            self.refresh()

    def move_frame(self, t: float) -> None:
        super().move_frame(t)
        if self.reshapes:
            half = 0.5 * t
            bend = half * self.a_acceleration - THIRD * t * t * self.a_jerk
            self.a = self.kept_a + t * (self.kept_a_rate + bend)
            self.a_rate = self.kept_a_rate + t * (self.a_acceleration - half * self.a_jerk)

    # -- rollback and saved state ----------------------------------------------------------------
    def get_state(self) -> list[float]:
        return [*super().get_state(), self.a, self.a_rate]

    def set_state(self, state: list[float]) -> None:
        super().set_state(state)
        self.a = state[12]
        self.a_rate = state[13]
        self.refresh()

    def keep(self) -> None:
        super().keep()
        self.kept_a = self.a
        self.kept_a_rate = self.a_rate

    def undo(self) -> None:
        self.a = self.kept_a
        self.a_rate = self.kept_a_rate
        super().undo()

    # -- observation -----------------------------------------------------------------------------
    def reactions(self) -> tuple[float, float, float, float]:
        """Normal force, tension, force on the parabola (x, y), all N, of the present state."""
        raise NotImplementedError

    def observe(self, group: int, values: Values, first: int) -> None:
        if group == 0:
            self.write_places(values, first)
        elif group == 1:
            self.write_velocities(values, first)
        elif group == 2:
            self.write_parabola(values, first)
        elif group == 3:
            self.write_energies(values, first + 18)
        elif group == 4:
            (
                values[first + 22],
                values[first + 23],
                values[first + 24],
                values[first + 25],
            ) = self.reactions()
        else:
            values[first + 26] = self.acceleration_error()

    def write_places(self, values: Values, first: int) -> None:
        """Write the outputs of group 0."""
        u = self.q0
        x = self.x + u
        y = self.y + self.a * u * u
        values[first] = u
        values[first + 1] = self.v0
        values[first + 2] = unwind(self.q1, self.turns)
        values[first + 3] = self.v1
        values[first + 4] = x
        values[first + 5] = y
        values[first + 8] = x + self.r * math.sin(self.q1)
        values[first + 9] = y - self.r * math.cos(self.q1)

    def write_velocities(self, values: Values, first: int) -> None:
        """Write the outputs of group 1."""
        u = self.q0
        vx = self.vx + self.v0
        vy = self.vy + (2.0 * (self.a * u) * self.v0 + self.a_rate * u * u)
        speed = self.r * self.v1
        values[first + 6] = vx
        values[first + 7] = vy
        values[first + 10] = vx + speed * math.cos(self.q1)
        values[first + 11] = vy + speed * math.sin(self.q1)

    def write_parabola(self, values: Values, first: int) -> None:
        """Write the outputs of group 2."""
        values[first + 12] = self.x
        values[first + 13] = self.y
        values[first + 14] = self.vx
        values[first + 15] = self.vy
        values[first + 16] = self.a
        values[first + 17] = self.a_rate
