"""Facts about the two systems, measured anew through their FMUs: python tests/benchmarks facts.

ratio    error of the Cartesian form over that of the angle at the same step of rk4
drift    growth of the drift without stabilisation, and when the bead falls to the centre
exact    solver.method = exact at any macro step
limits   largest step of rk4 up to which every step has an energy error below 10 % over 10 s
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from curvebound.cosim import RunFailed, Scene
from curvebound.study.linear_model import linearize
from curvebound.study.reference.reference import refer

__all__ = [
    "configure",
    "drift_law",
    "exact_errors",
    "fall_time",
    "form_ratio",
    "linear_bound",
    "run",
    "step_limit",
]


def _scene(fmu: str, start: Mapping[str, Any], stop: float, step: float, *paths: str) -> Scene:
    scene = Scene("facts", stop_time=stop, step=step)
    scene.add("it", fmu, {"solver.max_steps": 2_000_000_000, **start})
    scene.recorded = [f"it.{path}" for path in paths]
    return scene


def _worst(scene: Scene, reference: Any) -> float:
    result = scene.run()
    exact = reference.values(result.time)
    return max(float(np.abs(result[path] - exact[path][:, 0]).max()) for path in reference.paths)


def form_ratio(steps: tuple[float, ...] = (1e-2, 5e-3, 2e-3, 1e-3)) -> dict[float, float]:
    """Error of lagrange_multiplier without stabilisation over that of angle, by step of rk4."""
    ratios = {}
    reference = None
    for size in steps:
        errors = []
        for form in ("lagrange_multiplier", "angle"):
            start = {
                "model.formulation": form, "constraint.stabilization": "none",
                "solver.method": "rk4", "solver.step": size,
            }  # fmt: skip
            scene = _scene("BeadOnWire", start, 10.0, 0.1, "bead.x", "bead.y")
            reference = reference or refer(scene.check(), scene.recorded)
            errors.append(_worst(scene, reference))
        ratios[size] = errors[0] / errors[1]
    return ratios


def _drift_scene(size: float, stop: float, step: float) -> Scene:
    start = {
        "model.formulation": "lagrange_multiplier", "constraint.stabilization": "none",
        "solver.method": "rk4", "solver.step": size,
    }  # fmt: skip
    return _scene("BeadOnWire", start, stop, step, "constraint.drift")


def drift_law(
    sizes: tuple[float, ...] = (1e-3, 2e-3, 4e-3), stop: float = 1000.0
) -> tuple[float, float, float]:
    """(coefficient in m, exponent of the step, exponent of time) of the inward drift.

    -drift = coefficient (h / 1e-3 s)^p (t / 1000 s)^q, fitted where it is below 3 % of the radius.
    """
    points = []
    for size in sizes:
        result = _drift_scene(size, stop, 1.0).run()
        for t in np.geomspace(stop / 30.0, stop, 12):
            i = int(np.argmin(np.abs(result.time - t)))
            drift = -float(result["it.constraint.drift"][i])
            if 0.0 < drift < 0.03:
                points.append(
                    (math.log(size / 1e-3), math.log(result.time[i] / 1e3), math.log(drift))
                )
    a = np.array([[1.0, h, t] for h, t, _ in points])
    fit = np.linalg.lstsq(a, np.array([d for _, _, d in points]), rcond=None)[0]
    return math.exp(fit[0]), float(fit[1]), float(fit[2])


def fall_time(size: float, longest: float = 1500.0, within: float = 0.1) -> float:
    """Time in s at which the unstabilised bead comes `within` (m) of the centre, or inf.

    From a tenth of the radius on it is less than 0.1 s to the singularity p = 0, beyond which the
    bead is thrown out at hundreds of m/s. Every step is a communication point, so that none passes
    the centre unseen.
    """
    scene = _drift_scene(size, longest, size)
    try:
        result = scene.run()
    except RunFailed as error:
        result = error.result
    fallen = np.flatnonzero(result["it.constraint.drift"] < within - 1.0)
    return float(result.time[fallen[0]]) if len(fallen) else math.inf


def exact_errors(steps: tuple[float, ...] = (0.01, 0.1, 1.0, 2.5, 10.0)) -> dict[float, float]:
    """Largest error over 10 s of the linear model with `exact`, by macro step."""
    errors = {}
    reference = None
    for step in steps:
        start = {"model.fidelity": "linear", "solver.method": "exact"}
        scene = _scene("ParabolaPendulum", start, 10.0, step, "slider.u", "pendulum.angle")
        reference = reference or refer(scene.check(), scene.recorded)
        errors[step] = _worst(scene, reference)
    return errors


def step_limit(start: Mapping[str, float], above: float = 0.6, below: float = 1e-6) -> float:
    """Largest step of rk4 (s) up to which every step keeps the energy error below 10 % over 10 s.

    Single steps far above it hold too, by chance: it is looked for from above, in notches of 2 %,
    until a whole range of 3 to 1 has held. The energy error is energy.residual at its largest, over
    the energy of the start above the lowest.
    """

    def holds(size: float) -> bool:
        scene = _scene(
            "ParabolaPendulum", {**start, "solver.method": "rk4", "solver.step": size}, 10.0,
            size * max(1, round(0.05 / size)), "energy.residual", "energy.total",
        )  # fmt: skip
        try:
            result = scene.run()
        except RunFailed:
            return False
        # at rest at the vertex: bob hanging, of 1 kg on 1 m
        stake = float(result["it.energy.total"][0]) + 9.81
        return bool(np.abs(result["it.energy.residual"]).max() < 0.1 * stake)

    size, limit = above, math.inf
    while size > below:
        if not holds(size):
            limit = math.inf
        elif limit == math.inf:
            limit = size
        elif limit > 3.0 * size:
            return limit
        size /= 1.02
    return math.nan


def linear_bound(start: Mapping[str, float]) -> float:
    """2.83 over the faster frequency of the linear model (rad/s): rk4's own limit at rest."""
    rest = {"slider.u": 0.0, "pendulum.angle": 0.0}
    values = np.linalg.eigvals(linearize("ParabolaPendulum", {**start, **rest}, inputs=[]).A)
    return 2.0 * math.sqrt(2.0) / float(np.abs(values.imag).max())


def _say_ratio() -> None:
    for size, ratio in form_ratio().items():
        print(f"rk4, h = {size:g} s: Cartesian over angle {ratio:.0f}")


def _say_drift() -> None:
    coefficient, p, q = drift_law()
    print(f"drift: {coefficient:.2e} m (h/1e-3)^{p:.2f} (t/1000 s)^{q:.2f}, inward")
    for size, words in ((1.0 / 60.0, "1/60"), (0.01, "1e-2")):
        print(f"h = {words} s: the bead falls to the centre at {fall_time(size):.0f} s")


def _say_exact() -> None:
    for step, error in exact_errors().items():
        print(f"exact, macro step {step:g} s: error {error:.1e}")


def _say_limits() -> None:
    for ratio in (1.0, 1e2, 1e4, 1e6):
        limit = step_limit({"slider.mass": 1.0 / ratio})
        over = linear_bound({"slider.mass": 1.0 / ratio}) / limit  # 2.83 / omega
        print(
            f"m2/m1 = {ratio:g}: rk4 holds up to {limit:.2g} s; 2.83/omega is {over:.2g} times that"
        )
    for a in (5.0, 50.0, 500.0):
        limit = step_limit({"parabola.coefficient_start": a})
        over = linear_bound({"parabola.coefficient_start": a}) / limit
        print(f"a = {a:g} 1/m: rk4 holds up to {limit:.2g} s; 2.83/omega is {over:.2g} times that")


_SAY: dict[str, Callable[[], None]] = {
    "ratio": _say_ratio,
    "drift": _say_drift,
    "exact": _say_exact,
    "limits": _say_limits,
}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    choices = [*_SAY, []]  # []: what argparse checks where none is given
    parser.add_argument("facts", nargs="*", choices=choices, help=", ".join(_SAY))


def run(options: argparse.Namespace) -> int:
    """Print the facts asked for, all by default."""
    for name in options.facts or _SAY:
        _SAY[name]()
    return 0
