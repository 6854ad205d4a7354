"""A frame that is moved by given accelerations, and what every model in such a frame shares."""

from __future__ import annotations

import math
from typing import Final

from .angles import reduce_angle
from .base import Model, Values

__all__ = ["THIRD", "FramedModel"]

THIRD: Final = 1.0 / 3.0


class FramedModel(Model):
    """A model whose curve is fixed to a translating frame, at rest in the origin at the start.

    Frame acceleration and forces are constant over a communication step, or linear in time, so that
    position and velocity of the frame are polynomials of time there and move_frame() is exact.
    Inputs are no part of the saved state: call set_inputs() again after set_state() with others.
    """

    def __init__(self) -> None:
        super().__init__()
        # gravity (m/s2); frame: position (m), velocity (m/s), acceleration (m/s2), jerk (m/s3)
        self.gx: float = 0.0
        self.gy: float = 0.0
        self.x: float = 0.0
        self.y: float = 0.0
        self.vx: float = 0.0
        self.vy: float = 0.0
        self.ax: float = 0.0
        self.ay: float = 0.0
        self.jx: float = 0.0
        self.jy: float = 0.0
        #: whether the frame has a velocity or an acceleration
        self.moving: bool = False
        #: whole turns that the state angle does not contain
        self.turns: float = 0.0
        #: J, what energies_at() found: energies, and the size of what adds up to the potential one
        self.kinetic: float = 0.0
        self.potential: float = 0.0
        self.potential_size: float = 0.0
        #: J, energy.total at the start
        self.initial_energy: float = 0.0
        # what keep() remembers
        self.kept_q0: float = 0.0
        self.kept_q1: float = 0.0
        self.kept_v0: float = 0.0
        self.kept_v1: float = 0.0
        self.kept_work: float = 0.0
        self.kept_x: float = 0.0
        self.kept_y: float = 0.0
        self.kept_vx: float = 0.0
        self.kept_vy: float = 0.0
        self.kept_turns: float = 0.0
        self.kept_settles: bool = False

    def rest_frame(self, parameters: dict[str, float]) -> None:
        """Take gravity; put the frame at rest in the origin, without inputs or work done."""
        self.gx = parameters["gravity.x"]
        self.gy = parameters["gravity.y"]
        self.x = self.y = self.vx = self.vy = self.ax = self.ay = self.jx = self.jy = 0.0
        self.moving = False
        self.work = 0.0

    def note_initial_energy(self) -> None:
        """Remember energy.total; raises ValueError if the initial state is beyond the floats."""
        self.energies_at(0.0)
        self.initial_kinetic = self.kinetic
        self.initial_potential = self.potential
        self.initial_energy = self.kinetic + self.potential
        if not math.isfinite(self.initial_energy):
            raise ValueError(
                f"the initial energy is {self.initial_energy!r} J: masses, lengths, gravity and "
                "initial values multiply to more than a float holds; use smaller ones"
            )

    def energies(self) -> tuple[float, float]:
        """Kinetic and potential energy (J) of the present state."""
        self.energies_at(0.0)
        return self.kinetic, self.potential

    def energies_at(self, t: float) -> None:
        """Set kinetic, potential and potential_size, t s after the communication point."""
        raise NotImplementedError

    def balance(self, t: float) -> None:
        self.energies_at(t)
        self.balance_energy = self.kinetic + self.potential - self.work
        self.balance_size = self.kinetic + self.potential_size + math.fabs(self.work)

    def move_frame(self, t: float) -> None:
        if self.moving:
            half = 0.5 * t
            third = THIRD * t
            # the accelerations were the present ones less t times the jerk
            self.x = self.kept_x + t * (self.kept_vx + half * self.ax - third * t * self.jx)
            self.y = self.kept_y + t * (self.kept_vy + half * self.ay - third * t * self.jy)
            self.vx = self.kept_vx + t * (self.ax - half * self.jx)
            self.vy = self.kept_vy + t * (self.ay - half * self.jy)

    def write_energies(self, values: Values, at: int) -> None:
        """Write energy.kinetic, .potential, .total, .residual from values[at] on."""
        self.energies_at(0.0)
        total = self.kinetic + self.potential
        values[at] = self.kinetic
        values[at + 1] = self.potential
        values[at + 2] = total
        values[at + 3] = total - (self.initial_energy + self.work)

    # -- rollback and saved state ----------------------------------------------------------------
    def get_state(self) -> list[float]:
        return [
            self.q0,
            self.q1,
            self.v0,
            self.v1,
            self.work,
            self.x,
            self.y,
            self.vx,
            self.vy,
            self.turns,
            1.0 if self.settles else 0.0,
            self.initial_energy,
        ]

    def set_state(self, state: list[float]) -> None:
        expected = len(self.get_state())
        if len(state) != expected:
            raise ValueError(
                f"the saved state has {len(state)} numbers where {expected} belong: "
                "it was written by another model; pass one that this model wrote"
            )
        self.q0 = state[0]
        self.q1 = state[1]
        self.v0 = state[2]
        self.v1 = state[3]
        self.work = state[4]
        self.x = state[5]
        self.y = state[6]
        self.vx = state[7]
        self.vy = state[8]
        self.turns = state[9]
        self.settles = state[10] != 0.0
        self.initial_energy = state[11]

    def keep(self) -> None:
        self.kept_q0 = self.q0
        self.kept_q1 = self.q1
        self.kept_v0 = self.v0
        self.kept_v1 = self.v1
        self.kept_work = self.work
        self.kept_x = self.x
        self.kept_y = self.y
        self.kept_vx = self.vx
        self.kept_vy = self.vy
        self.kept_turns = self.turns
        self.kept_settles = self.settles

    def undo(self) -> None:
        self.q0 = self.kept_q0
        self.q1 = self.kept_q1
        self.v0 = self.kept_v0
        self.v1 = self.kept_v1
        self.work = self.kept_work
        self.x = self.kept_x
        self.y = self.kept_y
        self.vx = self.kept_vx
        self.vy = self.kept_vy
        self.turns = self.kept_turns
        self.settles = self.kept_settles
        self.refresh()

    # -- turns -----------------------------------------------------------------------------------
    def set_angle(self, angle: float) -> float:
        """Count the whole turns of an initial angle (rad) and return what remains."""
        rest, self.turns = reduce_angle(angle)
        return rest

    def take_turns(self, angle: float) -> float:
        """Move the whole turns of a state angle (rad) to the count and return what remains."""
        rest, turns = reduce_angle(angle)
        self.turns += turns
        return rest
