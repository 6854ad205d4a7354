"""Facts about the two systems, measured anew through their FMUs: python -m curvebound.study.facts.

ratio    error of the Cartesian form over that of the angle at the same step of rk4
drift    growth of the drift without stabilisation, and when the bead falls to the centre
exact    solver.method = exact at any macro step
limits   largest step of rk4 with an energy error below 10 % over 10 s
sweep    speed of a sweep: two workers against one, and against fmpy.simulate_fmu in a loop
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
import tempfile
import time as clock
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..cosim import RunFailed, Scene
from .reference import refer

__all__ = ["drift_law", "exact_errors", "fall_time", "form_ratio", "step_limit", "sweep_speed"]


def _scene(fmu: str, start: Mapping[str, Any], stop: float, step: float, *paths: str) -> Scene:
    scene = Scene("facts", stop_time=stop, step=step)
    scene.add("it", fmu, {"solver.max_steps": 2_000_000_000, **start})
    scene.recorded = [f"it.{path}" for path in paths]
    return scene


def _worst(scene: Scene, reference: Any) -> float:
    result = scene.run(fmpy_single=False)
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


def _drift_scene(size: float, stop: float) -> Scene:
    start = {
        "model.formulation": "lagrange_multiplier", "constraint.stabilization": "none",
        "solver.method": "rk4", "solver.step": size,
    }  # fmt: skip
    return _scene("BeadOnWire", start, stop, max(1.0, size), "constraint.drift")


def drift_law(
    sizes: tuple[float, ...] = (1e-3, 2e-3, 4e-3), stop: float = 1000.0
) -> tuple[float, float, float]:
    """(coefficient in m, exponent of the step, exponent of time) of the inward drift.

    -drift = coefficient (h / 1e-3 s)^p (t / 1000 s)^q, fitted where it is below 3 % of the radius.
    """
    points = []
    for size in sizes:
        result = _drift_scene(size, stop).run(fmpy_single=False)
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


def fall_time(size: float, longest: float = 1500.0) -> float:
    """Time in s at which the unstabilised bead has fallen halfway to the centre, or inf."""
    scene = _drift_scene(size, longest)
    try:
        result = scene.run(fmpy_single=False)
    except RunFailed as error:
        result = error.result
        if len(result.data) < 2:
            return math.inf
    fallen = np.flatnonzero(np.abs(result["it.constraint.drift"]) > 0.5)
    if len(fallen):
        return float(result.time[fallen[0]])
    return math.inf if result.complete else float(result.time[-1])


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
    """Largest step of rk4 (s) up to which the energy error stays below 10 % over 10 s.

    Found by going down in steps of 20 % to the first that holds, then by halving the gap; the
    energy error is the residual at its largest over the size of the initial energy.
    """

    def holds(size: float) -> bool:
        scene = _scene(
            "ParabolaPendulum", {**start, "solver.method": "rk4", "solver.step": size}, 10.0,
            max(0.01, size), "energy.residual", "energy.total",
        )  # fmt: skip
        try:
            result = scene.run(fmpy_single=False)
        except RunFailed:
            return False
        size_of = abs(float(result["it.energy.total"][0]))
        return bool(np.abs(result["it.energy.residual"]).max() < 0.1 * size_of)

    size = above
    while size > below and not holds(size):
        size *= 0.8
    low, high = size, size / 0.8
    for _ in range(5):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def sweep_speed(points: int = 400, rounds: int = 3) -> tuple[float, float]:
    """(speed of two workers over one, throughput over fmpy.simulate_fmu with the file name).

    The scene is a bead over 10 s at 100 communication points a second.
    """
    from fmpy import simulate_fmu

    from .sweep import Design, Sweep, axis

    def timed(count: int, workers: int) -> float:
        made = Sweep(
            "bead_on_wire", Design([axis(f"bead.bead.damping=0:1:{count}")]), ["final(bead.bead.y)"]
        )
        marks: list[tuple[float, int]] = []
        with tempfile.TemporaryDirectory() as folder:
            made.run(
                Path(folder) / "a.csv", workers=workers,
                progress=lambda done, _, __: marks.append((clock.perf_counter(), done)),
            )  # fmt: skip
        # from the first rows on: the start of the processes is not the sweep's speed
        first = next(i for i, (_, done) in enumerate(marks) if done > 0.1 * count)
        (a, at_a), (b, at_b) = marks[first], marks[-1]
        return (b - a) / (at_b - at_a)

    node = Sweep(
        "bead_on_wire", Design([axis("bead.bead.damping=0:1:2")]), ["final(bead.bead.y)"]
    ).scene.check().nodes["bead"]  # fmt: skip
    gains, against = [], []
    for _ in range(rounds):
        one, two = timed(points, 1), timed(points, 2)
        gains.append(one / two)
        began = clock.perf_counter()
        for i in range(10):
            simulate_fmu(
                str(node.fmu.path), stop_time=10.0, output_interval=0.01, output=["bead.y"],
                start_values={**node.start, "bead.damping": 0.1 * i},
            )  # fmt: skip
        against.append((clock.perf_counter() - began) / 10 / two)
    return statistics.median(gains), statistics.median(against)


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
        print(f"m2/m1 = {ratio:g}: rk4 holds up to h = {limit:.2g} s")
    for a in (5.0, 50.0, 500.0):
        limit = step_limit({"parabola.coefficient_start": a})
        print(f"a = {a:g} 1/m: rk4 holds up to h = {limit:.2g} s")


def _say_sweep() -> None:
    gain, against = sweep_speed()
    print(f"two workers: {gain:.2f} times the speed of one")
    print(f"two workers: {against:.1f} times fmpy.simulate_fmu called with the file name")


_SAY: dict[str, Callable[[], None]] = {
    "ratio": _say_ratio,
    "drift": _say_drift,
    "exact": _say_exact,
    "limits": _say_limits,
    "sweep": _say_sweep,
}


def main(arguments: list[str] | None = None) -> int:
    """Print the facts asked for, all by default."""
    parser = argparse.ArgumentParser(
        prog="python -m curvebound.study.facts", description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("facts", nargs="*", metavar="FACT", help=", ".join(_SAY))
    chosen = parser.parse_args(arguments).facts or list(_SAY)
    unknown = [name for name in chosen if name not in _SAY]
    if unknown:
        parser.error(f"there is no fact {unknown[0]}; choose from {', '.join(_SAY)}")
    for name in chosen:
        _SAY[name]()
    return 0


if __name__ == "__main__":
    sys.exit(main())
