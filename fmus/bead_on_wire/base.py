"""What both formulations of the bead on a wire share: variables, inputs, frame, work, outputs.

With p the position from the centre, v its rate, f the external force and k = d/m, the bead off the
wire would have the acceleration e - k v from the centre, e = gravity + f/m - (that of the centre).
"""

from __future__ import annotations

import math
from typing import ClassVar, Final

from curvebound.kernel.base import Values
from curvebound.kernel.frame import FramedModel

__all__ = ["BeadBase"]

_OUTPUTS: Final[dict[str, int]] = {
    "bead.x": 0,
    "bead.y": 0,
    "bead.vx": 0,
    "bead.vy": 0,
    "bead.angle": 0,
    "bead.angular_velocity": 0,
    "wire.x": 0,
    "wire.y": 0,
    "wire.vx": 0,
    "wire.vy": 0,
    "constraint.drift": 0,
    "energy.kinetic": 1,
    "energy.potential": 1,
    "energy.total": 1,
    "energy.residual": 1,
    "wire.fx": 2,
    "wire.fy": 2,
    "constraint.multiplier": 2,
    "constraint.force": 2,
}


class BeadBase(FramedModel):
    """What both formulations share: parameters, inputs, work, outputs."""

    PARAMETERS: ClassVar[tuple[str, ...]] = (
        "gravity.x",
        "gravity.y",
        "wire.radius",
        "bead.mass",
        "bead.damping",
        "bead.angle_start",
        "bead.angular_velocity_start",
        "constraint.stiffness",
        "constraint.damping",
    )
    CHOICES: ClassVar[tuple[str, ...]] = ("model.formulation", "constraint.stabilization")
    INPUTS: ClassVar[tuple[str, ...]] = ("wire.ax", "wire.ay", "bead.fx", "bead.fy")
    OUTPUTS: ClassVar[dict[str, int]] = _OUTPUTS
    FEEDTHROUGH: ClassVar[tuple[int, ...]] = (2,)

    def __init__(self) -> None:
        super().__init__()
        self.m: float = 1.0
        self.r: float = 1.0
        self.d: float = 0.0
        #: k = d/m, 1/s
        self.k: float = 0.0
        self.fx: float = 0.0
        self.fy: float = 0.0
        #: e, what acts on the free bead in the wire's frame, drag excepted, m/s2
        self.ex: float = 0.0
        self.ey: float = 0.0

    def remedy(self, trouble: str) -> str:
        if trouble == "drift":
            return "set constraint.stabilization = 3 (projection) or model.formulation = 2 (angle)"
        return ""

    def start(self, parameters: dict[str, float], choices: dict[str, int]) -> None:
        self.rest_frame(parameters)
        self.m = parameters["bead.mass"]
        self.r = parameters["wire.radius"]
        self.d = parameters["bead.damping"]
        self.k = self.d / self.m
        self.fx = self.fy = 0.0
        self.ex = self.gx
        self.ey = self.gy
        angle = self.set_angle(parameters["bead.angle_start"])
        self.place(angle, parameters["bead.angular_velocity_start"], parameters, choices)
        self.note_initial_energy()
        self.refresh()

    def place(
        self, angle: float, rate: float, parameters: dict[str, float], choices: dict[str, int]
    ) -> None:
        """Set the state to an angle within a turn (rad) and its rate (rad/s)."""
        raise NotImplementedError

    def take_inputs(self, t: float) -> None:
        self.ax = self.inputs[0] + t * self.slopes[0]
        self.ay = self.inputs[1] + t * self.slopes[1]
        self.fx = self.inputs[2] + t * self.slopes[2]
        self.fy = self.inputs[3] + t * self.slopes[3]
        self.jx = self.slopes[0]
        self.jy = self.slopes[1]
        self.ex = self.gx + self.fx / self.m - self.ax
        self.ey = self.gy + self.fy / self.m - self.ay

    def refresh(self) -> None:
        self.moving = self.ax != 0.0 or self.ay != 0.0 or self.vx != 0.0 or self.vy != 0.0
        self.works = self.moving or self.d != 0.0 or self.fx != 0.0 or self.fy != 0.0

    def work_rate(self, t: float, vx: float, vy: float, ax: float, ay: float) -> float:
        """Power (W) on the bead with velocity and acceleration relative to the centre."""
        drift = self.d * (vx * vx + vy * vy)
        if not self.moving:
            return self.fx * vx + self.fy * vy - drift
        # the wire's force on the bead is m (a - e), and works along the motion of the centre
        wx = self.vx + t * self.ax
        wy = self.vy + t * self.ay
        return (
            self.fx * (vx + wx)
            + self.fy * (vy + wy)
            + self.m * ((ax - self.ex) * wx + (ay - self.ey) * wy)
            - drift
        )

    def relative(self) -> tuple[float, float, float, float]:
        """Position (m) and velocity (m/s) relative to the centre."""
        raise NotImplementedError

    def multiplier(self) -> float:
        """lambda (N/m) of the present state and inputs."""
        raise NotImplementedError

    def rotation(self) -> tuple[float, float, float]:
        """Continuous angle (rad), angular velocity (rad/s), drift |p| - r (m)."""
        raise NotImplementedError

    def energies_at(self, t: float) -> None:
        px, py, vx, vy = self.relative()
        vx += self.vx + t * self.ax
        vy += self.vy + t * self.ay
        lift_x = self.gx * (px + (self.x + t * (self.vx + 0.5 * t * self.ax)))
        lift_y = self.gy * (py + (self.y + t * (self.vy + 0.5 * t * self.ay)))
        self.kinetic = 0.5 * self.m * (vx * vx + vy * vy)
        self.potential = -self.m * (lift_x + lift_y)
        self.potential_size = self.m * (math.fabs(lift_x) + math.fabs(lift_y))

    def observe(self, group: int, values: Values, first: int) -> None:
        if group == 0:
            px, py, vx, vy = self.relative()
            values[first] = self.x + px
            values[first + 1] = self.y + py
            values[first + 2] = self.vx + vx
            values[first + 3] = self.vy + vy
            values[first + 4], values[first + 5], values[first + 10] = self.rotation()
            values[first + 6] = self.x
            values[first + 7] = self.y
            values[first + 8] = self.vx
            values[first + 9] = self.vy
        elif group == 1:
            self.write_energies(values, first + 11)
        else:
            px, py, vx, vy = self.relative()
            factor = self.multiplier()
            values[first + 15] = self.d * vx - factor * px
            values[first + 16] = self.d * vy - factor * py
            values[first + 17] = factor
            values[first + 18] = factor * self.r
