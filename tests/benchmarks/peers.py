"""General tools that one could take instead: scipy, heyoka and MuJoCo, each where installed.

Each gets the equations in the form that suits it best: the closed forms of the accelerations, terms
without effect (damping, drive) left out.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable, Sequence
from typing import Any

from .contenders import ANGLE, CARTESIAN, PENDULUM, Contender, Run, State4
from .references import DURATION, on_wire

__all__ = ["decades", "peers"]

_G = 9.81
_A = 0.5

#: system -> start in the coordinates in which it is integrated: coordinates, then rates
_STARTS: dict[str, tuple[float, ...]] = {
    ANGLE: (0.5 * math.pi, 0.0),
    CARTESIAN: (1.0, 0.0, 0.0, 0.0),
    PENDULUM: (0.5, 0.5, 0.0, 0.0),
}


def decades(first: int, last: int, per_decade: int = 2) -> tuple[float, ...]:
    """Tolerances 10^first, ..., 10^last, `per_decade` a decade, getting smaller."""
    return tuple(
        10.0 ** (-n / per_decade) for n in range(-first * per_decade, -last * per_decade + 1)
    )


def _result(system: str, values: Sequence[float]) -> State4:
    """The state in the coordinates of the references."""
    if system == ANGLE:
        return on_wire(float(values[0]), float(values[1]))
    q0, q1, v0, v1 = (float(x) for x in values)
    return (q0, q1, v0, v1)


# -- scipy ---------------------------------------------------------------------------------------
def _bead_angle(t: float, y: Sequence[float]) -> tuple[float, ...]:
    return (y[1], -_G * math.sin(y[0]))


def _bead_cartesian(t: float, s: Sequence[float]) -> tuple[float, ...]:
    x, y, vx, vy = s
    pull = (vx * vx + vy * vy - _G * y) / (x * x + y * y)
    return (vx, vy, -pull * x, -pull * y - _G)


def _pendulum(t: float, y: Sequence[float]) -> tuple[float, ...]:
    u, angle, du, rate = y
    sine, cosine = math.sin(angle), math.cos(angle)
    q = 2.0 * _A * u
    w, k = cosine + q * sine, sine - q * cosine
    g = _G + 2.0 * _A * du * du
    swing = rate * rate
    d = 1.0 + q * q + k * k
    return (du, rate, (k * (g * cosine + swing) - q * g) / d, -k * (2.0 * g + w * swing) / d)


_EQUATIONS: dict[str, Callable[[float, Sequence[float]], tuple[float, ...]]] = {
    ANGLE: _bead_angle,
    CARTESIAN: _bead_cartesian,
    PENDULUM: _pendulum,
}


def _scipy(integrate: Any, method: str, system: str) -> Callable[[float], Run]:
    equations, start = _EQUATIONS[system], _STARTS[system]

    def prepare(tolerance: float) -> Run:
        # relative tolerances below 2.3e-14 are refused
        relative = max(tolerance, 3e-14)
        result: list[Any] = []

        def go() -> None:
            result[:] = [
                integrate.solve_ivp(
                    equations, (0.0, DURATION), start, method, rtol=relative, atol=tolerance
                )
            ]

        return Run(lambda: None, go, lambda: _result(system, result[0].y[:, -1]))

    return prepare


# -- heyoka --------------------------------------------------------------------------------------
def _heyoka(heyoka: Any, system: str) -> Callable[[float], Run]:
    """Taylor series; the integrator is compiled once per tolerance, before the clock starts.

    At some tolerances it fails from the bead's start in the angle: released from the horizontal the
    series has only the powers 2, 6, 10, ..., so that at the orders 8, 12 and 16 both coefficients
    from which it takes the step size vanish.
    """
    u, th, du, dth = heyoka.make_vars("u", "th", "du", "dth")
    start = list(_STARTS[system])
    if system == ANGLE:
        equations = [(th, dth), (dth, -_G * heyoka.sin(th))]
    elif system == CARTESIAN:
        pull = (du * du + dth * dth - _G * th) / (u * u + th * th)
        equations = [(u, du), (th, dth), (du, -pull * u), (dth, -pull * th - _G)]
    else:
        sine, cosine = heyoka.sin(th), heyoka.cos(th)
        q = 2.0 * _A * u
        w, k = cosine + q * sine, sine - q * cosine
        g = _G + 2.0 * _A * du * du
        swing = dth * dth
        d = 1.0 + q * q + k * k
        equations = [
            (u, du),
            (th, dth),
            (du, (k * (g * cosine + swing) - q * g) / d),
            (dth, -k * (2.0 * g + w * swing) / d),
        ]

    def prepare(tolerance: float) -> Run:
        integrator = heyoka.taylor_adaptive(equations, start, tol=tolerance)

        def reset() -> None:
            integrator.time = 0.0
            integrator.state[:] = start

        return Run(
            reset,
            lambda: integrator.propagate_until(DURATION, max_steps=100000),
            lambda: _result(system, integrator.state),
        )

    return prepare


# -- MuJoCo --------------------------------------------------------------------------------------
#: a point mass: MuJoCo wants a moment of inertia, this one changes the motion by 1e-14
_POINT = '<inertial pos="0 0 {height}" mass="1" diaginertia="1e-14 1e-14 1e-14"/>'

_HINGE = f"""
<mujoco>
  <option timestep="{{step!r}}" integrator="{{integrator}}" gravity="0 0 -{_G}">
    <flag contact="disable" constraint="disable"/>
  </option>
  <worldbody>
    <body><joint type="hinge" axis="0 -1 0"/>{_POINT.format(height=-1)}</body>
  </worldbody>
</mujoco>
"""

# The slider slides along x and z, tied to z = a x^2 by an equality as stiff as the step allows.
_SLIDES = f"""
<mujoco>
  <option timestep="{{step!r}}" integrator="{{integrator}}" gravity="0 0 -{_G}">
    <flag contact="disable"/>
  </option>
  <worldbody>
    <body>
      <joint name="u" type="slide" axis="1 0 0"/>
      <joint name="height" type="slide" axis="0 0 1"/>
      {_POINT.format(height=0)}
      <body><joint type="hinge" axis="0 -1 0"/>{_POINT.format(height=-1)}</body>
    </body>
  </worldbody>
  <equality>
    <joint joint1="height" joint2="u" polycoef="0 0 {_A} 0 0"
      solref="{{twice!r}} 1" solimp="0.9999 0.9999 0.001 0.5 2"/>
  </equality>
</mujoco>
"""


def _mujoco(mujoco: Any, integrator: str, system: str) -> Callable[[float], Run]:
    text, start = (_HINGE, (0.5 * math.pi,)) if system == ANGLE else (_SLIDES, (0.5, 0.125, 0.5))
    picked = (0,) if system == ANGLE else (0, 2)

    def prepare(step: float) -> Run:
        model = mujoco.MjModel.from_xml_string(
            text.format(step=step, twice=2.0 * step, integrator=integrator)
        )
        data = mujoco.MjData(model)
        count = round(DURATION / step)

        def reset() -> None:
            mujoco.mj_resetData(model, data)
            data.qpos[:] = start

        def state() -> State4:
            return _result(
                system, [*(data.qpos[i] for i in picked), *(data.qvel[i] for i in picked)]
            )

        return Run(reset, lambda: mujoco.mj_step(model, data, nstep=count), state)

    return prepare


def peers(quick: bool) -> tuple[list[Contender], list[str]]:
    """The contenders among the installed tools, and a line for each tool that is absent."""
    contenders: list[Contender] = []
    absent: list[str] = []
    systems = (ANGLE, CARTESIAN, PENDULUM)
    tight = decades(-4, -6, 1) if quick else decades(-4, -13)
    steps = (1e-2, 5e-3) if quick else (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
    for name in ("scipy.integrate", "heyoka", "mujoco"):
        tool = name.partition(".")[0]
        try:
            module = importlib.import_module(name)
        except ImportError:
            absent.append(f"{tool} is not installed: left out (pip install 'curvebound[peers]')")
            continue
        if tool == "scipy":
            contenders += [
                Contender("scipy", method, s, "tolerance", tight, _scipy(module, method, s))
                for s in systems
                for method in ("DOP853", "LSODA")
            ]
        elif tool == "heyoka":
            finest = tight if quick else decades(-4, -15)
            contenders += [
                Contender("heyoka", "Taylor", s, "tolerance", finest, _heyoka(module, s))
                for s in systems
            ]
        else:
            contenders += [
                Contender("MuJoCo", method, s, "step", steps, _mujoco(module, method, s))
                for s in (ANGLE, PENDULUM)
                for method in ("Euler", "RK4")
            ]
    return contenders, absent
