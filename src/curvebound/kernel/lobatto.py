"""One step of the eight-stage Lobatto IIIA method, order 14, solved by sweeps.

Collocation at the Lobatto points c0 = 0 < c1 < ... < c7 = 1 (Hairer, Norsett, Wanner 1993,
sec. II.7; Hairer, Wanner 1996, sec. IV.5). With K_j the accelerations at the points, a step of h s
has the stages

    V_i = v + h sum_j A_ij K_j,    Q_i = q + c_i h v + h^2 sum_j R_ij K_j,    R = A A

The first guess of the K_j extrapolates the polynomial through those of the last step. Each sweep
evaluates them anew, the early half with the old ones, the late half with the new early ones, and
gains two to three digits. The evaluations of a half do not wait for each other, and the sums are
added in pairs: the processor overlaps them. For the same sake the sums are written out.
"""

from __future__ import annotations

import math
from typing import Final

from .base import Model
from .polynomial import C1, C2, C3, C4, C5, C6, extrapolated, tail
from .rounding import NEGLIGIBLE, Rounding

__all__ = ["Collocation"]

# rows 1 to 7 of A and R; row 7 of A are the weights of the quadrature
A10: Final = 0.02473751443887554
A11: Final = 0.04489266260275502
A12: Final = -0.008140767742389754
A13: Final = 0.004254082548545939
A14: Final = -0.0027042050750158203
A15: Final = 0.0018453866944819887
A16: Final = -0.0012262209861064897
A17: Final = 0.00047147326405026763
A20: Final = 0.013258719822130255
A21: Final = 0.1206497328240974
A22: Final = 0.0799976357866516
A23: Final = -0.014480830962625474
A24: Final = 0.007631949206834005
A25: Final = -0.004832668923134717
A26: Final = 0.003104950015920876
A27: Final = -0.0011795784864451048
A30: Final = 0.021034356725214087
A31: Final = 0.0962801783120814
A32: Final = 0.1890416498443269
A33: Final = 0.10124595564768955
A34: Final = -0.01813732021145422
A35: Final = 0.009417009802430584
A36: Final = -0.005608861642537465
A37: Final = 0.0020774225710097206
A40: Final = 0.015779720286133135
A41: Final = 0.11096097521429048
A42: Final = 0.1611443364393216
A43: Final = 0.22436671754080617
A44: Final = 0.10498344168166239
A45: Final = -0.018480303602574723
A46: Final = 0.009071935259671617
A47: Final = -0.00317721386807123
A50: Final = 0.019036721343587963
A51: Final = 0.10224716355583215
A52: Final = 0.1753940151648869
A53: Final = 0.19859744812251795
A54: Final = 0.22071022829197742
A55: Final = 0.09056371045510057
A56: Final = -0.015297619252344383
A57: Final = 0.004598423035012602
A60: Final = 0.01738566959309259
A61: Final = 0.1065783345578595
A62: Final = 0.1687159595472702
A63: Final = 0.20893360240436776
A64: Final = 0.201975314780806
A65: Final = 0.17870211398414193
A66: Final = 0.060459450968998
A67: Final = -0.006880371581732683
A70: Final = 0.017857142857142856
A71: Final = 0.10535211357175302
A72: Final = 0.17056134624175218
A73: Final = 0.20622939732935194
A74: Final = 0.20622939732935194
A75: Final = 0.17056134624175218
A76: Final = 0.10535211357175302
A77: Final = 0.017857142857142856
R10: Final = 0.0010716376256772945
R11: Final = 0.001250359966023172
R12: Final = -0.00045106961510159484
R13: Final = 0.00034035917836718006
R14: Final = -0.00028772230906461236
R15: Final = 0.0002406331238572394
R16: Final = -0.00018141390148910432
R17: Final = 7.353961977264641e-05
R20: Final = 0.0038019953685877192
R21: Final = 0.014233135297707797
R22: Final = 0.0033848484129790964
R23: Final = -0.0009532395797565681
R24: Final = 0.000665388070955887
R25: Final = -0.0005253573343539759
R26: Final = 0.00038828376833693483
R27: Final = -0.00015646127424077537
R30: Final = 0.006850476287387093
R31: Final = 0.035449482298828223
R32: Final = 0.031615777224893386
R33: Final = 0.004980176236382347
R34: Final = -0.0011840493012781562
R35: Final = 0.000757567701412784
R36: Final = -0.0005278167206196453
R37: Final = 0.00020935212419791765
R40: Final = 0.011006666569755765
R41: Final = 0.05641707433227133
R42: Final = 0.06906733564617198
R43: Final = 0.04197960226825477
R44: Final = 0.004980176236382347
R45: Final = -0.0009956343470731795
R46: Final = 0.0005547062208782797
R47: Final = -0.00020935212419791765
R50: Final = 0.014055147488555138
R51: Final = 0.07747654969114304
R52: Final = 0.1003958221823718
R53: Final = 0.08326019976403491
R54: Final = 0.03847792054378954
R55: Final = 0.0033848484129790964
R56: Final = -0.0005182659103270261
R57: Final = 0.00015646127424077537
R60: Final = 0.01678550523146556
R61: Final = 0.09165825322935181
R62: Final = 0.12504380953361185
R63: Final = 0.11118332620316981
R64: Final = 0.06864775612106869
R65: Final = 0.023430927277927262
R66: Final = 0.001250359966023172
R67: Final = -7.353961977264641e-05
R70: Final = 0.017857142857142856
R71: Final = 0.09859589035129697
R72: Final = 0.135741262879239
R73: Final = 0.12469652444944243
R74: Final = 0.08153287287990951
R75: Final = 0.03482008336251321
R76: Final = 0.00675622322045605

#: longest step, in units of the last, that is extrapolated to: rounding grows as the seventh power
#: and passes for the scale of the motion, so that a wrong step is taken for a right one
FARTHEST: Final = 16.0
#: part of the tolerance to which sweeps converge: what they leave adds up from step to step, while
#: errors of the symmetric method cancel where the motion returns
CONVERGED: Final = 0.5
#: most sweeps, and the slowest convergence, at which a step is not better halved
MOST_SWEEPS: Final = 12
SLOWEST: Final = 0.5
#: the convergence that is counted on at most, and that after one sweep, when it is the last step's
FASTEST: Final = 0.003
PRESUMED: Final = 0.1
#: changes below this, relative, are rounding
ROUNDING: Final = 5e-16
#: how far changes and tails can be above the rounding of the accelerations
SPREAD: Final = 4.0
TINY: Final = 1e-300
#: part of the tolerance to which an error has to come up for rounding to be forgotten
BELOW: Final = 0.01
#: what lies above, or is no number, has left the finite numbers; cheaper than math.isfinite here
LARGEST: Final = 1e300


class Collocation:
    """The step, and its memory: accelerations a of q0 and b of q1 at the points of the last."""

    def __init__(self) -> None:
        self.a0: float = 0.0
        self.a1: float = 0.0
        self.a2: float = 0.0
        self.a3: float = 0.0
        self.a4: float = 0.0
        self.a5: float = 0.0
        self.a6: float = 0.0
        self.a7: float = 0.0
        self.b0: float = 0.0
        self.b1: float = 0.0
        self.b2: float = 0.0
        self.b3: float = 0.0
        self.b4: float = 0.0
        self.b5: float = 0.0
        self.b6: float = 0.0
        self.b7: float = 0.0
        #: s, size of the last step; 0: there was none
        self.h: float = 0.0
        #: factor by which its last sweep reduced the change
        self.contraction: float = SLOWEST
        #: whether to look closely at rounding in the next step, for it may be all that there is
        self.noisy: bool = False
        #: sweeps made, for the caller to count
        self.sweeps: int = 0

    def take(self, other: Collocation) -> None:
        """Remember what `other` does."""
        self.a0, self.a1, self.a2, self.a3 = other.a0, other.a1, other.a2, other.a3
        self.a4, self.a5, self.a6, self.a7 = other.a4, other.a5, other.a6, other.a7
        self.b0, self.b1, self.b2, self.b3 = other.b0, other.b1, other.b2, other.b3
        self.b4, self.b5, self.b6, self.b7 = other.b4, other.b5, other.b6, other.b7
        self.h = other.h
        self.contraction = other.contraction
        self.noisy = other.noisy

    # fmt: off
    def get_state(self) -> list[float]:
        """All that the next step depends on."""
        return [
            self.a0, self.a1, self.a2, self.a3, self.a4, self.a5, self.a6, self.a7,
            self.b0, self.b1, self.b2, self.b3, self.b4, self.b5, self.b6, self.b7,
            self.h, self.contraction, 1.0 if self.noisy else 0.0,
        ]
    # fmt: on

    def set_state(self, state: list[float]) -> None:
        """Return to what get_state() gave."""
        self.a0, self.a1, self.a2, self.a3 = state[0:4]
        self.a4, self.a5, self.a6, self.a7 = state[4:8]
        self.b0, self.b1, self.b2, self.b3 = state[8:12]
        self.b4, self.b5, self.b6, self.b7 = state[12:16]
        self.h, self.contraction, noisy = state[16:]
        self.noisy = noisy != 0.0

    # fmt: off
    def step(
        self, model: Model, rounding: Rounding, t: float, h: float, a0: float, b0: float,
        tolerance: float,
    ) -> float:
        """Try a step of h s from time t (s), where the acceleration is (a0, b0).

        Returns the estimated error relative to the rates of the coordinates: up to `tolerance`
        the model's state and work have been advanced, else they are as before. Infinite: the
        sweeps, which converge to a part of it, diverge. Lets the model's ArithmeticError and
        ValueError pass.
        """
        q0, q1, v0, v1 = model.q0, model.q1, model.v0, model.v1
        # a coordinate that rests is left out until a sweep finds an acceleration of it
        two = q1 != 0.0 or v1 != 0.0 or b0 != 0.0
        b1 = b2 = b3 = b4 = b5 = b6 = b7 = 0.0
        if 0.0 < h <= FARTHEST * self.h:
            r = 2.0 * h / self.h
            a1, a2, a3, a4, a5, a6, a7 = extrapolated(
                self.a0, self.a1, self.a2, self.a3, self.a4, self.a5, self.a6, self.a7, a0, r
            )
            if two:
                b1, b2, b3, b4, b5, b6, b7 = extrapolated(
                    self.b0, self.b1, self.b2, self.b3, self.b4, self.b5, self.b6, self.b7, b0, r
                )
        else:
            a1 = a2 = a3 = a4 = a5 = a6 = a7 = a0
            b1 = b2 = b3 = b4 = b5 = b6 = b7 = b0
        x1 = x2 = x3 = x4 = x5 = x6 = x7 = q1
        w1 = w2 = w3 = w4 = w5 = w6 = w7 = v1
        y7, u7 = end(q0, v0, h, a0, a1, a2, a3, a4, a5, a6, a7)
        if two:
            x7, w7 = end(q1, v1, h, b0, b1, b2, b3, b4, b5, b6, b7)
        scale0 = scale1 = 0.0
        known = self.noisy
        noise0 = noise1 = 0.0
        if known:
            rounding.look_closely(model, t)
            noise0 = rounding.noise0
            noise1 = rounding.noise1
        contraction = self.contraction
        change = 0.0
        error = 0.0
        work = 0.0
        closing = False
        hh = h * h
        for sweep in range(MOST_SWEEPS):
            last0 = u7
            last1 = w7
            y1 = q0 + (C1 * h * v0 + hh * (((R11 * a1 + R12 * a2) + (R13 * a3 + R14 * a4))
                + ((R15 * a5 + R16 * a6) + (R17 * a7 + R10 * a0))))
            u1 = v0 + h * (((A11 * a1 + A12 * a2) + (A13 * a3 + A14 * a4)) + ((A15 * a5 + A16 * a6)
                + (A17 * a7 + A10 * a0)))
            y2 = q0 + (C2 * h * v0 + hh * (((R22 * a2 + R23 * a3) + (R24 * a4 + R25 * a5))
                + ((R26 * a6 + R27 * a7) + (R20 * a0 + R21 * a1))))
            u2 = v0 + h * (((A22 * a2 + A23 * a3) + (A24 * a4 + A25 * a5)) + ((A26 * a6 + A27 * a7)
                + (A20 * a0 + A21 * a1)))
            y3 = q0 + (C3 * h * v0 + hh * (((R33 * a3 + R34 * a4) + (R35 * a5 + R36 * a6))
                + ((R37 * a7 + R30 * a0) + (R31 * a1 + R32 * a2))))
            u3 = v0 + h * (((A33 * a3 + A34 * a4) + (A35 * a5 + A36 * a6)) + ((A37 * a7 + A30 * a0)
                + (A31 * a1 + A32 * a2)))
            y4 = q0 + (C4 * h * v0 + hh * (((R44 * a4 + R45 * a5) + (R46 * a6 + R47 * a7))
                + ((R40 * a0 + R41 * a1) + (R42 * a2 + R43 * a3))))
            u4 = v0 + h * (((A44 * a4 + A45 * a5) + (A46 * a6 + A47 * a7)) + ((A40 * a0 + A41 * a1)
                + (A42 * a2 + A43 * a3)))
            if two:
                x1 = q1 + (C1 * h * v1 + hh * (((R11 * b1 + R12 * b2) + (R13 * b3 + R14 * b4))
                    + ((R15 * b5 + R16 * b6) + (R17 * b7 + R10 * b0))))
                w1 = v1 + h * (((A11 * b1 + A12 * b2) + (A13 * b3 + A14 * b4)) + ((A15 * b5
                    + A16 * b6) + (A17 * b7 + A10 * b0)))
                x2 = q1 + (C2 * h * v1 + hh * (((R22 * b2 + R23 * b3) + (R24 * b4 + R25 * b5))
                    + ((R26 * b6 + R27 * b7) + (R20 * b0 + R21 * b1))))
                w2 = v1 + h * (((A22 * b2 + A23 * b3) + (A24 * b4 + A25 * b5)) + ((A26 * b6
                    + A27 * b7) + (A20 * b0 + A21 * b1)))
                x3 = q1 + (C3 * h * v1 + hh * (((R33 * b3 + R34 * b4) + (R35 * b5 + R36 * b6))
                    + ((R37 * b7 + R30 * b0) + (R31 * b1 + R32 * b2))))
                w3 = v1 + h * (((A33 * b3 + A34 * b4) + (A35 * b5 + A36 * b6)) + ((A37 * b7
                    + A30 * b0) + (A31 * b1 + A32 * b2)))
                x4 = q1 + (C4 * h * v1 + hh * (((R44 * b4 + R45 * b5) + (R46 * b6 + R47 * b7))
                    + ((R40 * b0 + R41 * b1) + (R42 * b2 + R43 * b3))))
                w4 = v1 + h * (((A44 * b4 + A45 * b5) + (A46 * b6 + A47 * b7)) + ((A40 * b0
                    + A41 * b1) + (A42 * b2 + A43 * b3)))
            if closing:
                work += A71 * model.power(t + C1 * h, y1, x1, u1, w1, a1, b1)
                work += A72 * model.power(t + C2 * h, y2, x2, u2, w2, a2, b2)
                work += A73 * model.power(t + C3 * h, y3, x3, u3, w3, a3, b3)
                work += A74 * model.power(t + C4 * h, y4, x4, u4, w4, a4, b4)
            else:
                model.acceleration(t + C1 * h, y1, x1, u1, w1)
                a1 = model.a0
                b1 = model.a1
                model.acceleration(t + C2 * h, y2, x2, u2, w2)
                a2 = model.a0
                b2 = model.a1
                model.acceleration(t + C3 * h, y3, x3, u3, w3)
                a3 = model.a0
                b3 = model.a1
                model.acceleration(t + C4 * h, y4, x4, u4, w4)
                a4 = model.a0
                b4 = model.a1
            y5 = q0 + (C5 * h * v0 + hh * (((R55 * a5 + R56 * a6) + (R57 * a7 + R50 * a0))
                + ((R51 * a1 + R52 * a2) + (R53 * a3 + R54 * a4))))
            u5 = v0 + h * (((A55 * a5 + A56 * a6) + (A57 * a7 + A50 * a0)) + ((A51 * a1 + A52 * a2)
                + (A53 * a3 + A54 * a4)))
            y6 = q0 + (C6 * h * v0 + hh * (((R66 * a6 + R67 * a7) + (R60 * a0 + R61 * a1))
                + ((R62 * a2 + R63 * a3) + (R64 * a4 + R65 * a5))))
            u6 = v0 + h * (((A66 * a6 + A67 * a7) + (A60 * a0 + A61 * a1)) + ((A62 * a2 + A63 * a3)
                + (A64 * a4 + A65 * a5)))
            y7 = q0 + (h * v0 + hh * (((R70 * a0 + R71 * a1) + (R72 * a2 + R73 * a3)) + ((R74 * a4
                + R75 * a5) + R76 * a6)))
            u7 = v0 + h * (((A77 * a7 + A70 * a0) + (A71 * a1 + A72 * a2)) + ((A73 * a3 + A74 * a4)
                + (A75 * a5 + A76 * a6)))
            if two:
                x5 = q1 + (C5 * h * v1 + hh * (((R55 * b5 + R56 * b6) + (R57 * b7 + R50 * b0))
                    + ((R51 * b1 + R52 * b2) + (R53 * b3 + R54 * b4))))
                w5 = v1 + h * (((A55 * b5 + A56 * b6) + (A57 * b7 + A50 * b0)) + ((A51 * b1
                    + A52 * b2) + (A53 * b3 + A54 * b4)))
                x6 = q1 + (C6 * h * v1 + hh * (((R66 * b6 + R67 * b7) + (R60 * b0 + R61 * b1))
                    + ((R62 * b2 + R63 * b3) + (R64 * b4 + R65 * b5))))
                w6 = v1 + h * (((A66 * b6 + A67 * b7) + (A60 * b0 + A61 * b1)) + ((A62 * b2
                    + A63 * b3) + (A64 * b4 + A65 * b5)))
                x7 = q1 + (h * v1 + hh * (((R70 * b0 + R71 * b1) + (R72 * b2 + R73 * b3))
                    + ((R74 * b4 + R75 * b5) + R76 * b6)))
                w7 = v1 + h * (((A77 * b7 + A70 * b0) + (A71 * b1 + A72 * b2)) + ((A73 * b3
                    + A74 * b4) + (A75 * b5 + A76 * b6)))
            if closing:
                work += A75 * model.power(t + C5 * h, y5, x5, u5, w5, a5, b5)
                work += A76 * model.power(t + C6 * h, y6, x6, u6, w6, a6, b6)
                work += A77 * model.power(t + h, y7, x7, u7, w7, a7, b7)
                break
            d5, d6, e5, e6 = a5, a6, b5, b6
            model.acceleration(t + C5 * h, y5, x5, u5, w5)
            a5 = model.a0
            b5 = model.a1
            model.acceleration(t + C6 * h, y6, x6, u6, w6)
            a6 = model.a0
            b6 = model.a1
            model.acceleration(t + h, y7, x7, u7, w7)
            a7 = model.a0
            b7 = model.a1
            self.sweeps += 1
            if not two:
                two = b1 != 0.0 or b2 != 0.0 or b3 != 0.0 or b4 != 0.0
                two = two or b5 != 0.0 or b6 != 0.0 or b7 != 0.0
                if two:
                    continue
            if scale0 == 0.0:
                # sizes of the rates, each coordinate for itself
                scale0 = max(math.fabs(v0), math.fabs(u7)) + h * max(math.fabs(a0), math.fabs(a7))
                scale0 = 1.0 / max(scale0, NEGLIGIBLE * rounding.size0 / h + TINY)
                scale1 = max(math.fabs(v1), math.fabs(w7)) + h * max(math.fabs(b0), math.fabs(b7))
                scale1 = 1.0 / max(scale1, NEGLIGIBLE * rounding.size1 / h + TINY)
            before = change
            change = max(math.fabs(u7 - last0) * scale0, math.fabs(w7 - last1) * scale1)
            left = change * max(contraction, PRESUMED)
            if sweep == 0:
                # the end may be hit by chance: what the next sweep would change it by at most
                still0 = A75 * math.fabs(a5 - d5) + A76 * math.fabs(a6 - d6)
                still1 = A75 * math.fabs(b5 - e5) + A76 * math.fabs(b6 - e6)
                left = max(left, h * max(still0 * scale0, still1 * scale1))
            if before > 0.0:
                contraction = max(change / before, FASTEST)
                left = change * contraction
            done = left <= max(CONVERGED * tolerance, ROUNDING)
            if not done:
                if sweep > 1 and contraction > SLOWEST:
                    if not known:
                        known = True
                        rounding.estimate(model, t)
                        noise0 = rounding.noise0
                        noise1 = rounding.noise1
                    if not change <= h * (noise0 * scale0 + noise1 * scale1):
                        return math.inf
                    done = True
                elif sweep != 1:
                    continue
            # known well enough after two sweeps to spare the further ones of too large a step
            error = h * tail(a0, a1, a2, a3, a4, a5, a6, a7, noise0) * scale0
            if two:
                error = max(error, h * tail(b0, b1, b2, b3, b4, b5, b6, b7, noise1) * scale1)
            if not error <= tolerance:
                if known:
                    return error
                known = True
                # less what is rounding, which shorter steps have too
                rounding.estimate(model, t)
                noise0 = rounding.noise0
                noise1 = rounding.noise1
                error = h * tail(a0, a1, a2, a3, a4, a5, a6, a7, noise0) * scale0
                if two:
                    error = max(error, h * tail(b0, b1, b2, b3, b4, b5, b6, b7, noise1) * scale1)
                if not error <= tolerance:
                    return error
            if done:
                if not model.works:
                    break
                work = A70 * model.power(t, q0, q1, v0, v1, a0, b0)
                closing = True
        else:
            return math.inf
        y7, u7 = end(q0, v0, h, a0, a1, a2, a3, a4, a5, a6, a7)
        if two:
            x7, w7 = end(q1, v1, h, b0, b1, b2, b3, b4, b5, b6, b7)
        # fmt: on
        if not math.fabs(y7) + math.fabs(x7) + math.fabs(u7) + math.fabs(w7) <= LARGEST:
            return math.inf
        model.q0, model.q1, model.v0, model.v1 = y7, x7, u7, w7
        model.work += h * work
        self.a0, self.a1, self.a2, self.a3 = a0, a1, a2, a3
        self.a4, self.a5, self.a6, self.a7 = a4, a5, a6, a7
        self.b0, self.b1, self.b2, self.b3 = b0, b1, b2, b3
        self.b4, self.b5, self.b6, self.b7 = b4, b5, b6, b7
        self.h = h
        self.contraction = contraction
        if known:
            self.noisy = error <= BELOW * tolerance
        return error


def end(
    q: float,
    v: float,
    h: float,
    k0: float,
    k1: float,
    k2: float,
    k3: float,
    k4: float,
    k5: float,
    k6: float,
    k7: float,
) -> tuple[float, float]:
    """Q_7, V_7, the end of the step, of one coordinate with the accelerations k0 ... k7."""
    hh = h * h
    x = q + (
        h * v
        + hh
        * (((R70 * k0 + R71 * k1) + (R72 * k2 + R73 * k3)) + ((R74 * k4 + R75 * k5) + R76 * k6))
    )
    w = v + h * (
        ((A77 * k7 + A70 * k0) + (A71 * k1 + A72 * k2))
        + ((A73 * k3 + A74 * k4) + (A75 * k5 + A76 * k6))
    )
    return x, w


# fmt: on
