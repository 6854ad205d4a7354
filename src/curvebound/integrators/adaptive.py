"""Adaptive explicit Runge-Kutta integration: the Dormand-Prince pair 8(5,3) with PI step control.

Pair and combined error estimate: Hairer, Norsett, Wanner 1993, sec. II.5 and II.10. Step control:
Gustafsson 1991, with the exponents of Hairer and Wanner 1996, sec. IV.2.
"""

from __future__ import annotations

import math
from typing import Final

from ..models.base import Model
from .base import DONE, NOT_FINITE, STEP_TOO_SMALL, TOO_MANY_STEPS, Method
from .dormand_prince_853 import (
    A0201,
    A0301,
    A0302,
    A0401,
    A0403,
    A0501,
    A0503,
    A0504,
    A0601,
    A0604,
    A0605,
    A0701,
    A0704,
    A0705,
    A0706,
    A0801,
    A0804,
    A0805,
    A0806,
    A0807,
    A0901,
    A0904,
    A0905,
    A0906,
    A0907,
    A0908,
    A1001,
    A1004,
    A1005,
    A1006,
    A1007,
    A1008,
    A1009,
    A1101,
    A1104,
    A1105,
    A1106,
    A1107,
    A1108,
    A1109,
    A1110,
    A1201,
    A1204,
    A1205,
    A1206,
    A1207,
    A1208,
    A1209,
    A1210,
    A1211,
    B01,
    B06,
    B07,
    B08,
    B09,
    B10,
    B11,
    B12,
    C02,
    C03,
    C04,
    C05,
    C06,
    C07,
    C08,
    C09,
    C10,
    C11,
    P01,
    P06,
    P07,
    P08,
    P09,
    P10,
    P11,
    R0301,
    R0401,
    R0402,
    R0501,
    R0502,
    R0503,
    R0601,
    R0603,
    R0604,
    R0701,
    R0703,
    R0704,
    R0705,
    R0801,
    R0803,
    R0804,
    R0805,
    R0806,
    R0901,
    R0903,
    R0904,
    R0905,
    R0906,
    R0907,
    R1001,
    R1003,
    R1004,
    R1005,
    R1006,
    R1007,
    R1008,
    R1101,
    R1103,
    R1104,
    R1105,
    R1106,
    R1107,
    R1108,
    R1109,
    R1201,
    R1203,
    R1204,
    R1205,
    R1206,
    R1207,
    R1208,
    R1209,
    R1210,
    U01,
    U04,
    U05,
    U06,
    U07,
    U08,
    U09,
    U10,
    U11,
    V01,
    V04,
    V05,
    V06,
    V07,
    V08,
    V09,
    V10,
    V11,
    X01,
    X06,
    X07,
    X08,
    X09,
    X10,
    X11,
    X12,
    Y01,
    Y06,
    Y07,
    Y08,
    Y09,
    Y10,
    Y11,
    Y12,
)

__all__ = ["Adaptive"]

#: the new position and velocity, the norm of the error in units of the tolerance's scale, the work
Trial = tuple[float, float, float, float, float, float]

#: exponents of the error of this step and of the last one in the next step size
PRESENT: Final = 0.125
LAST: Final = 0.04
SAFETY: Final = 0.9
#: bounds of the ratio of one step size to the next, up and down
MOST_GROWTH: Final = 5.0
MOST_SHRINKING: Final = 0.2
#: the smallest error, in units of the tolerance, that the controller distinguishes from none
LEAST_ERROR: Final = 1e-6
#: what lies above, or is no number, has left the finite numbers; cheaper than math.isfinite here
LARGEST: Final = 1e300
#: smallest step relative to the communication step
RESOLUTION: Final = 1e-14


class Adaptive(Method):
    """Twelve evaluations per step, order 8, error estimates of order 5 and 3 combined.

    The tolerance is relative to natural magnitudes: for a coordinate the larger of its value and
    its scale, for a rate that scale times the fastest relative rate of the whole motion. A motion
    that starts from rest, or rests, thus needs no absolute tolerance.
    """

    ORDER = 8
    CHOOSES_STEP = True

    def __init__(self) -> None:
        super().__init__()
        #: s, step that the error control wishes to make next; 0: not begun
        self.wished: float = 0.0
        #: log of the last accepted error in units of the tolerance
        self.log_error: float = 0.0

    def reset(self) -> None:
        super().reset()
        self.wished = 0.0
        self.log_error = 0.0

    def get_state(self) -> list[float]:
        return [self.wished, self.log_error]

    def set_state(self, state: list[float]) -> None:
        self.wished, self.log_error = state

    def advance(
        self, model: Model, duration: float, count: int, tolerance: float, max_steps: int
    ) -> int:
        settles = model.settles
        wished = self.wished
        last = self.log_error
        a0, a1 = model.acceleration(0.0, model.q0, model.q1, model.v0, model.v1)
        self.evaluations += 1
        if not math.fabs(a0) + math.fabs(a1) <= LARGEST:
            return NOT_FINITE
        if wished <= 0.0:
            wished = first_step(model, a0, a1, duration, tolerance)
        least = duration * RESOLUTION
        t = 0.0
        rejected = False
        for _ in range(max_steps):
            remaining = duration - t
            h = wished
            ends = h >= remaining
            cut = True
            if ends:
                h = remaining
            elif 2.0 * h > remaining:
                h = 0.5 * remaining
            else:
                cut = False
            try:
                q0, q1, v0, v1, error, work = self.trial(model, t, h, a0, a1)
                error /= tolerance
            except (ArithmeticError, ValueError):
                # a stage left the model's domain or the finite numbers: the step is far too large
                error = math.inf
            if error < 1.0:
                log_error = math.log(max(error, LEAST_ERROR))
                growth = SAFETY * math.exp(LAST * last - PRESENT * log_error)
                growth = min(max(growth, MOST_SHRINKING), 1.0 if rejected else MOST_GROWTH)
                if not cut:
                    wished = h * growth
                    last = log_error
                elif h * growth > wished:
                    wished = h * growth
                rejected = False
                self.steps += 1
                model.q0, model.q1, model.v0, model.v1 = q0, q1, v0, v1
                model.work += work
                if settles:
                    model.settle(h)
                if ends:
                    self.wished = wished
                    self.log_error = last
                    return DONE
                t += h
                a0, a1 = model.acceleration(t, model.q0, model.q1, model.v0, model.v1)
                self.evaluations += 1
            else:
                rejected = True
                if error <= LARGEST:
                    shrinking = SAFETY * math.exp(-PRESENT * math.log(error))
                    wished = h * max(shrinking, MOST_SHRINKING)
                else:
                    wished = 0.1 * h
                if wished < least:
                    self.reached = wished
                    return STEP_TOO_SMALL
        self.reached = wished
        return TOO_MANY_STEPS

    def trial(self, model: Model, t: float, h: float, k010: float, k011: float) -> Trial:
        """One step of h s from the model's state, whose acceleration is k01; error before / tol."""
        works = model.works
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        hh = h * h
        self.evaluations += 11
        work = 0.0
        if works:
            work = B01 * model.power(t, q0, q1, v0, v1, k010, k011)
        s = t + C02 * h
        g = C02 * h
        x0 = q0 + (g * v0)
        x1 = q1 + (g * v1)
        w0 = v0 + h * (A0201 * k010)
        w1 = v1 + h * (A0201 * k011)
        k020, k021 = model.acceleration(s, x0, x1, w0, w1)
        s = t + C03 * h
        g = C03 * h
        x0 = q0 + (g * v0 + hh * (R0301 * k010))
        x1 = q1 + (g * v1 + hh * (R0301 * k011))
        w0 = v0 + h * (A0301 * k010 + A0302 * k020)
        w1 = v1 + h * (A0301 * k011 + A0302 * k021)
        k030, k031 = model.acceleration(s, x0, x1, w0, w1)
        s = t + C04 * h
        g = C04 * h
        x0 = q0 + (g * v0 + hh * (R0401 * k010 + R0402 * k020))
        x1 = q1 + (g * v1 + hh * (R0401 * k011 + R0402 * k021))
        w0 = v0 + h * (A0401 * k010 + A0403 * k030)
        w1 = v1 + h * (A0401 * k011 + A0403 * k031)
        k040, k041 = model.acceleration(s, x0, x1, w0, w1)
        s = t + C05 * h
        g = C05 * h
        x0 = q0 + (g * v0 + hh * (R0501 * k010 + R0502 * k020 + R0503 * k030))
        x1 = q1 + (g * v1 + hh * (R0501 * k011 + R0502 * k021 + R0503 * k031))
        w0 = v0 + h * (A0501 * k010 + A0503 * k030 + A0504 * k040)
        w1 = v1 + h * (A0501 * k011 + A0503 * k031 + A0504 * k041)
        k050, k051 = model.acceleration(s, x0, x1, w0, w1)
        s = t + C06 * h
        g = C06 * h
        x0 = q0 + (g * v0 + hh * (R0601 * k010 + R0603 * k030 + R0604 * k040))
        x1 = q1 + (g * v1 + hh * (R0601 * k011 + R0603 * k031 + R0604 * k041))
        w0 = v0 + h * (A0601 * k010 + A0604 * k040 + A0605 * k050)
        w1 = v1 + h * (A0601 * k011 + A0604 * k041 + A0605 * k051)
        k060, k061 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B06 * model.power(s, x0, x1, w0, w1, k060, k061)
        s = t + C07 * h
        g = C07 * h
        x0 = q0 + (g * v0 + hh * (R0701 * k010 + R0703 * k030 + R0704 * k040 + R0705 * k050))
        x1 = q1 + (g * v1 + hh * (R0701 * k011 + R0703 * k031 + R0704 * k041 + R0705 * k051))
        w0 = v0 + h * (A0701 * k010 + A0704 * k040 + A0705 * k050 + A0706 * k060)
        w1 = v1 + h * (A0701 * k011 + A0704 * k041 + A0705 * k051 + A0706 * k061)
        k070, k071 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B07 * model.power(s, x0, x1, w0, w1, k070, k071)
        s = t + C08 * h
        g = C08 * h
        x0 = q0 + (
            g * v0 + hh * (R0801 * k010 + R0803 * k030 + R0804 * k040 + R0805 * k050 + R0806 * k060)
        )
        x1 = q1 + (
            g * v1 + hh * (R0801 * k011 + R0803 * k031 + R0804 * k041 + R0805 * k051 + R0806 * k061)
        )
        w0 = v0 + h * (A0801 * k010 + A0804 * k040 + A0805 * k050 + A0806 * k060 + A0807 * k070)
        w1 = v1 + h * (A0801 * k011 + A0804 * k041 + A0805 * k051 + A0806 * k061 + A0807 * k071)
        k080, k081 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B08 * model.power(s, x0, x1, w0, w1, k080, k081)
        s = t + C09 * h
        g = C09 * h
        x0 = q0 + (
            g * v0
            + hh
            * (
                R0901 * k010
                + R0903 * k030
                + R0904 * k040
                + R0905 * k050
                + R0906 * k060
                + R0907 * k070
            )
        )
        x1 = q1 + (
            g * v1
            + hh
            * (
                R0901 * k011
                + R0903 * k031
                + R0904 * k041
                + R0905 * k051
                + R0906 * k061
                + R0907 * k071
            )
        )
        w0 = v0 + h * (
            A0901 * k010 + A0904 * k040 + A0905 * k050 + A0906 * k060 + A0907 * k070 + A0908 * k080
        )
        w1 = v1 + h * (
            A0901 * k011 + A0904 * k041 + A0905 * k051 + A0906 * k061 + A0907 * k071 + A0908 * k081
        )
        k090, k091 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B09 * model.power(s, x0, x1, w0, w1, k090, k091)
        s = t + C10 * h
        g = C10 * h
        x0 = q0 + (
            g * v0
            + hh
            * (
                R1001 * k010
                + R1003 * k030
                + R1004 * k040
                + R1005 * k050
                + R1006 * k060
                + R1007 * k070
                + R1008 * k080
            )
        )
        x1 = q1 + (
            g * v1
            + hh
            * (
                R1001 * k011
                + R1003 * k031
                + R1004 * k041
                + R1005 * k051
                + R1006 * k061
                + R1007 * k071
                + R1008 * k081
            )
        )
        w0 = v0 + h * (
            A1001 * k010
            + A1004 * k040
            + A1005 * k050
            + A1006 * k060
            + A1007 * k070
            + A1008 * k080
            + A1009 * k090
        )
        w1 = v1 + h * (
            A1001 * k011
            + A1004 * k041
            + A1005 * k051
            + A1006 * k061
            + A1007 * k071
            + A1008 * k081
            + A1009 * k091
        )
        k100, k101 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B10 * model.power(s, x0, x1, w0, w1, k100, k101)
        s = t + C11 * h
        g = C11 * h
        x0 = q0 + (
            g * v0
            + hh
            * (
                R1101 * k010
                + R1103 * k030
                + R1104 * k040
                + R1105 * k050
                + R1106 * k060
                + R1107 * k070
                + R1108 * k080
                + R1109 * k090
            )
        )
        x1 = q1 + (
            g * v1
            + hh
            * (
                R1101 * k011
                + R1103 * k031
                + R1104 * k041
                + R1105 * k051
                + R1106 * k061
                + R1107 * k071
                + R1108 * k081
                + R1109 * k091
            )
        )
        w0 = v0 + h * (
            A1101 * k010
            + A1104 * k040
            + A1105 * k050
            + A1106 * k060
            + A1107 * k070
            + A1108 * k080
            + A1109 * k090
            + A1110 * k100
        )
        w1 = v1 + h * (
            A1101 * k011
            + A1104 * k041
            + A1105 * k051
            + A1106 * k061
            + A1107 * k071
            + A1108 * k081
            + A1109 * k091
            + A1110 * k101
        )
        k110, k111 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B11 * model.power(s, x0, x1, w0, w1, k110, k111)
        s = t + h
        g = h
        x0 = q0 + (
            g * v0
            + hh
            * (
                R1201 * k010
                + R1203 * k030
                + R1204 * k040
                + R1205 * k050
                + R1206 * k060
                + R1207 * k070
                + R1208 * k080
                + R1209 * k090
                + R1210 * k100
            )
        )
        x1 = q1 + (
            g * v1
            + hh
            * (
                R1201 * k011
                + R1203 * k031
                + R1204 * k041
                + R1205 * k051
                + R1206 * k061
                + R1207 * k071
                + R1208 * k081
                + R1209 * k091
                + R1210 * k101
            )
        )
        w0 = v0 + h * (
            A1201 * k010
            + A1204 * k040
            + A1205 * k050
            + A1206 * k060
            + A1207 * k070
            + A1208 * k080
            + A1209 * k090
            + A1210 * k100
            + A1211 * k110
        )
        w1 = v1 + h * (
            A1201 * k011
            + A1204 * k041
            + A1205 * k051
            + A1206 * k061
            + A1207 * k071
            + A1208 * k081
            + A1209 * k091
            + A1210 * k101
            + A1211 * k111
        )
        k120, k121 = model.acceleration(s, x0, x1, w0, w1)
        if works:
            work += B12 * model.power(s, x0, x1, w0, w1, k120, k121)
        x0 = q0 + (
            h * v0
            + hh
            * (
                P01 * k010
                + P06 * k060
                + P07 * k070
                + P08 * k080
                + P09 * k090
                + P10 * k100
                + P11 * k110
            )
        )
        x1 = q1 + (
            h * v1
            + hh
            * (
                P01 * k011
                + P06 * k061
                + P07 * k071
                + P08 * k081
                + P09 * k091
                + P10 * k101
                + P11 * k111
            )
        )
        w0 = v0 + h * (
            B01 * k010
            + B06 * k060
            + B07 * k070
            + B08 * k080
            + B09 * k090
            + B10 * k100
            + B11 * k110
            + B12 * k120
        )
        w1 = v1 + h * (
            B01 * k011
            + B06 * k061
            + B07 * k071
            + B08 * k081
            + B09 * k091
            + B10 * k101
            + B11 * k111
            + B12 * k121
        )
        e5q0 = hh * (
            U01 * k010
            + U04 * k040
            + U05 * k050
            + U06 * k060
            + U07 * k070
            + U08 * k080
            + U09 * k090
            + U10 * k100
            + U11 * k110
        )
        e5q1 = hh * (
            U01 * k011
            + U04 * k041
            + U05 * k051
            + U06 * k061
            + U07 * k071
            + U08 * k081
            + U09 * k091
            + U10 * k101
            + U11 * k111
        )
        e3q0 = hh * (
            V01 * k010
            + V04 * k040
            + V05 * k050
            + V06 * k060
            + V07 * k070
            + V08 * k080
            + V09 * k090
            + V10 * k100
            + V11 * k110
        )
        e3q1 = hh * (
            V01 * k011
            + V04 * k041
            + V05 * k051
            + V06 * k061
            + V07 * k071
            + V08 * k081
            + V09 * k091
            + V10 * k101
            + V11 * k111
        )
        e5v0 = h * (
            X01 * k010
            + X06 * k060
            + X07 * k070
            + X08 * k080
            + X09 * k090
            + X10 * k100
            + X11 * k110
            + X12 * k120
        )
        e5v1 = h * (
            X01 * k011
            + X06 * k061
            + X07 * k071
            + X08 * k081
            + X09 * k091
            + X10 * k101
            + X11 * k111
            + X12 * k121
        )
        e3v0 = h * (
            Y01 * k010
            + Y06 * k060
            + Y07 * k070
            + Y08 * k080
            + Y09 * k090
            + Y10 * k100
            + Y11 * k110
            + Y12 * k120
        )
        e3v1 = h * (
            Y01 * k011
            + Y06 * k061
            + Y07 * k071
            + Y08 * k081
            + Y09 * k091
            + Y10 * k101
            + Y11 * k111
            + Y12 * k121
        )
        # the fastest relative rate, 1/s; never less than what moves q by its scale within 1000 h
        s0 = model.q0_scale
        s1 = model.q1_scale
        rate0 = (max(math.fabs(v0), math.fabs(w0)) + h * math.fabs(k010)) / s0
        rate1 = (max(math.fabs(v1), math.fabs(w1)) + h * math.fabs(k011)) / s1
        rate = max(max(rate0, rate1), 1e-3 / h)
        d0 = 1.0 / max(max(math.fabs(q0), math.fabs(x0)), s0)
        d1 = 1.0 / max(max(math.fabs(q1), math.fabs(x1)), s1)
        r0 = 1.0 / (rate * s0)
        r1 = 1.0 / (rate * s1)
        e5q0 *= d0
        e5q1 *= d1
        e5v0 *= r0
        e5v1 *= r1
        e3q0 *= d0
        e3q1 *= d1
        e3v0 *= r0
        e3v1 *= r1
        e5 = e5q0 * e5q0 + e5q1 * e5q1 + e5v0 * e5v0 + e5v1 * e5v1
        e3 = e3q0 * e3q0 + e3q1 * e3q1 + e3v0 * e3v0 + e3v1 * e3v1
        error = 0.0
        if e5 > 0.0:
            error = e5 / math.sqrt(e5 + 0.01 * e3)
        if not math.fabs(x0) + math.fabs(x1) + math.fabs(w0) + math.fabs(w1) <= LARGEST:
            error = math.inf
        return x0, x1, w0, w1, error, h * work


def first_step(model: Model, a0: float, a1: float, duration: float, tolerance: float) -> float:
    """A cautious first step (s) from the relative rates at the start."""
    rate = max(math.fabs(model.v0) / model.q0_scale, math.fabs(model.v1) / model.q1_scale)
    curvature = max(math.fabs(a0) / model.q0_scale, math.fabs(a1) / model.q1_scale)
    rate += math.sqrt(curvature)
    if rate * duration <= tolerance:
        return duration
    return min(duration, math.exp(0.125 * math.log(tolerance)) / rate)
