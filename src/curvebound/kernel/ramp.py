"""Inputs that are linear in time over a communication step, for every model and every method.

The equations of a model know its inputs as constants, and where its frame is by their time since
the communication point. Evaluated at that time, with the inputs of that time and the frame moved
there, they are those of changing inputs: nothing in them needs to know.
"""

from __future__ import annotations

import math

from .base import ALIKE, Inputs, Model

__all__ = ["Ramp"]

Rows = list[list[float]]


class Ramp(Model):
    """Stands for a model in Method.advance(), between begin() and end()."""

    def __init__(self) -> None:
        super().__init__()
        self.model: Model = Model()
        #: s, the communication step, and by which times differ that are meant to be the same
        self.duration: float = 0.0
        self.alike: float = 0.0
        #: what the propagator needs, of the start and of the end, while `known`
        self.known: bool = False
        self.systems: list[Rows] = []
        self.forms: list[Rows] = []

    def begin(self, model: Model, slopes: Inputs, duration: float) -> None:
        """Take a model, its keep() called, for `duration` s with inputs that rise by `slopes`."""
        self.model = model
        self.input_count = model.input_count
        model.begin_rise(slopes)
        self.duration = duration
        self.alike = ALIKE * math.fabs(duration)
        self.known = False
        self.take_state()
        self.q0_scale, self.q1_scale = model.q0_scale, model.q1_scale
        self.is_linear = model.is_linear
        # a bound: of the start, and of where the inputs lead
        magnification = model.magnification
        model.move(duration)
        self.magnification = max(magnification, model.magnification)
        self.works = True
        self.settles = model.settles

    def end(self) -> None:
        """Leave the model at the end of the communication step, with the inputs of that time."""
        model = self.model
        self.give_state()
        model.work = self.work
        model.end_rise(self.duration)

    def at(self, t: float) -> None:
        """Bring the model's inputs and frame to time t."""
        if math.fabs(t - self.model.moved) > self.alike:
            self.model.move(t)

    def take_state(self) -> None:
        """Take the model's state over."""
        model = self.model
        self.q0, self.q1, self.v0, self.v1 = model.q0, model.q1, model.v0, model.v1
        self.work = model.work

    def give_state(self) -> None:
        """Hand the state to the model."""
        model = self.model
        model.q0, model.q1, model.v0, model.v1 = self.q0, self.q1, self.v0, self.v1
        model.work = self.work

    # -- equations ---------------------------------------------------------------------------------
    def acceleration(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        model = self.model
        if math.fabs(t - model.moved) > self.alike:
            model.move(t)
        model.acceleration(0.0, q0, q1, v0, v1)
        self.a0 = model.a0
        self.a1 = model.a1

    def power(
        self, t: float, q0: float, q1: float, v0: float, v1: float, a0: float, a1: float
    ) -> float:
        model = self.model
        if math.fabs(t - model.moved) > self.alike:
            model.move(t)
        return model.power(0.0, q0, q1, v0, v1, a0, a1)

    def jacobian(self, t: float, q0: float, q1: float, v0: float, v1: float) -> None:
        model = self.model
        if math.fabs(t - model.moved) > self.alike:
            model.move(t)
        model.jacobian(0.0, q0, q1, v0, v1)
        self.a0 = model.a0
        self.a1 = model.a1
        self.a0_q0, self.a0_q1, self.a1_q0, self.a1_q1 = (
            model.a0_q0, model.a0_q1, model.a1_q0, model.a1_q1
        )  # fmt: skip
        self.a0_v0, self.a0_v1, self.a1_v0, self.a1_v1 = (
            model.a0_v0, model.a0_v1, model.a1_v0, model.a1_v1
        )  # fmt: skip

    def balance(self, t: float) -> None:
        self.at(t)
        self.give_state()
        model = self.model
        model.balance(0.0)
        self.balance_energy = model.balance_energy
        self.balance_size = model.balance_size

    def settle(self, h: float) -> None:
        self.give_state()
        self.model.settle(h)
        self.take_state()

    # -- for the propagator ------------------------------------------------------------------------
    def know(self) -> None:
        """Find systems and forms of the start and of the end."""
        if not self.known:
            model = self.model
            self.at(0.0)
            systems = [model.linear_system()]
            forms = [model.power_form()]
            self.at(self.duration)
            systems.append(model.linear_system())
            forms.append(model.power_form())
            self.systems = systems
            self.forms = forms
            self.known = True

    def linear_system(self) -> Rows:
        """A, shape (6, 6), for z = (q0, q1, v0, v1, 1, time in units of the communication step)."""
        self.know()
        return lengthened(self.systems[0], self.systems[1], 1.0 / self.duration)

    def separation(self) -> tuple[Rows, Rows, Rows]:
        self.at(0.0)
        first, ahead, back = self.model.separation()
        self.at(self.duration)
        last, _, _ = self.model.separation()
        if len(first) == 0 or len(last) == 0:
            return [], [], []
        for rows in (ahead, back):
            for row in rows:
                row.append(0.0)
            rows.append([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        return lengthened(first, last, 1.0 / self.duration), ahead, back

    def power_form(self) -> Rows:
        self.know()
        first: Rows = self.forms[0]
        last: Rows = self.forms[1]
        change = [last[i][4] - first[i][4] for i in range(5)]
        change[4] *= 0.5
        rows = [[*first[i], change[i]] for i in range(5)]
        rows.append([*change, 0.0])
        return rows

    def varies(self) -> bool:
        """Whether coefficients of the linear equations change, not the forcing alone."""
        self.know()
        for rows in (self.systems, self.forms):
            for i in range(4):
                if rows[0][i][:4] != rows[1][i][:4]:
                    return True
        return False

    def variation(self) -> str:
        """The inputs whose slopes alone make the coefficients vary, with these."""
        names = self.model.INPUTS
        slopes = [self.model.slopes[i] for i in range(self.input_count)]
        found = []
        for i in range(self.input_count):
            for k in range(self.input_count):
                self.model.slopes[k] = slopes[k] if k == i else 0.0
            self.model.move(0.0)
            self.known = False
            if slopes[i] != 0.0 and self.varies():
                found.append(f"{names[i]} with its slope of {slopes[i]!r} per s")
        return " and ".join(found)


def lengthened(first: Rows, last: Rows, rate: float) -> Rows:
    """The system whose forcing goes from that of one to that of the other, at `rate` (1/s)."""
    rows = [[*first[i], last[i][4] - first[i][4]] for i in range(5)]
    rows.append([0.0, 0.0, 0.0, 0.0, rate, 0.0])
    return rows
