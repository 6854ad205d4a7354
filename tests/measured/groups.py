"""What the READMEs and the FMUs' documentation state, measured: one function per group of figures.

Each returns plain data. Names in SPEED depend on the machine's speed and are not checked anew.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "fmi"))

from harness import Extracted, final, simulated
from measured.random_points import motions, points
from solutions import ANGLE, BAUMGARTE, LINEAR, NONLINEAR, PROJECTION, UNSTABILISED, Solution

from curvebound.cosim import load_scene, scene_names
from curvebound.fmi.build import build
from curvebound.fmi.compile import why_not

__all__ = ["GROUPS", "LEVELS", "PICTURES", "SPEED"]

Data = dict[str, Any]
ROOT = Path(__file__).parents[2]

#: figures that say how fast this machine was at that moment
SPEED = {"wall", "seconds", "times", "costs"}
#: sections of the cost benchmark, and the errors for which it tells the cost of a method
COSTS = ("kernel", "fmu", "accuracy", "size")
ROUNDS = "3"
LEVELS = ("1e-04", "1e-06", "1e-08", "1e-10", "1e-12")

#: pictures of the README, drawn from runs of these scenes
PICTURES = ("bead_on_wire", "pendulum_large")


def demo(*, draw: bool = False) -> Data:
    """What `curvebound demo` prints: the first FMU, and each scene. draw: write PICTURES too."""
    with tempfile.TemporaryDirectory() as folder:
        built = build("BeadOnWire", Path(folder), compiled=not why_not())
        *how, size, seconds = built.message.partition(": ")[2].split(", ")
    fmu = {"how": ", ".join(how), "kB": int(size.split()[0]), "seconds": float(seconds.split()[0])}
    scenes: dict[str, Data] = {}
    for name in scene_names():
        scene = load_scene(name)
        if name in PICTURES and draw:
            from curvebound.view import write_picture

            write_picture(scene.run(), ROOT / "scenarios" / f"{name}.png", title=name)
        scene.recorded = []
        scene.needs.errors = {}
        result = scene.run()

        def column(ending: str, result: Any = result) -> list[Any]:
            return [result[one] for one in result.names if one.endswith(ending)]

        drifts = column(".constraint.drift")
        scenes[name] = {
            "simulated": float(result.time[-1] - result.time[0]),
            "wall": round(result.wall, 2),
            "steps": sum(int(steps[-1]) for steps in column(".solver.steps")),
            "residual": max(float(np.abs(x).max()) for x in column(".energy.residual")),
            "drift": max((float(np.abs(x).max()) for x in drifts), default=None),
        }
    return {"fmu": fmu, "scenes": scenes}


@cache
def _fmus() -> dict[str, Extracted]:
    folder = Path(tempfile.mkdtemp(prefix="curvebound-measured-"))
    names = ("BeadOnWire", "ParabolaPendulum")
    return {name: Extracted(build(name, folder, compiled=not why_not()).path) for name in names}


def errors() -> Data:
    """Largest error of a position after 10 s from the default start."""
    fmus = _fmus()

    def error(solution: Solution, interval: float = 0.01, **more: str) -> float:
        method = {name.replace("_", "."): value for name, value in more.items()}
        result = simulated(
            fmus[solution.fmu], {**solution.parameters, **method}, solution.names,
            interval=interval,
        )  # fmt: skip
        return float(
            np.abs(np.subtract(final(result, solution.names[:2]), solution.at_10[:2])).max()
        )

    exact = [error(LINEAR, interval, solver_method="exact") for interval in (0.01, 1.0, 10.0)]
    return {
        "angle": error(ANGLE),
        "projection": error(PROJECTION),
        "none": error(UNSTABILISED),
        "nonlinear": error(NONLINEAR),
        "exact": max(exact),
    }


def models() -> Data:
    """Formulations of the bead at the same steps of rk4, and what the linear fidelity is off by."""
    fmus = _fmus()
    tight = {"solver.method": "adaptive", "solver.tolerance": 1e-13}

    def run(solution: Solution, parameters: dict[str, Any]) -> Any:
        return simulated(
            fmus[solution.fmu], {**solution.parameters, **parameters}, solution.names[:2],
            interval=0.1,
        )  # fmt: skip

    def worst(a: Any, b: Any, names: tuple[str, ...]) -> float:
        return max(float(np.abs(a[name] - b[name]).max()) for name in names)

    truth = run(ANGLE, tight)
    ratios: dict[str, list[float]] = {}
    for step in (1e-2, 5e-3, 2e-3):
        size = {"solver.step": step}
        of_angle = worst(run(ANGLE, size), truth, ANGLE.names[:2])
        for name, form in (
            ("projection", PROJECTION), ("baumgarte", BAUMGARTE), ("none", UNSTABILISED)
        ):  # fmt: skip
            ratios.setdefault(name, []).append(
                worst(run(form, size), truth, form.names[:2]) / of_angle
            )
    linear = run(LINEAR, {"solver.method": "exact"})
    found: Data = {name: median(values) for name, values in ratios.items()}
    found["linear"] = worst(linear, run(NONLINEAR, tight), NONLINEAR.names[:2])
    return found


def cost() -> Data:
    """Ratios of CPU times from interleaved runs, and what errors cost each method."""
    from benchmarks.__main__ import main

    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "cost.json"
        sections = [word for name in COSTS for word in ("--only", name)]
        main(["cost", *sections, "--rounds", ROUNDS, "--json", str(out)])
        data = json.loads(out.read_text(encoding="utf-8"))
    kept = ("name", "limit", "at_least", "measured")
    costs = {
        table["title"]: {
            row["tool and method"].removeprefix("FMU "): [row[level] for level in LEVELS]
            for row in table["rows"]
            if row["tool and method"].startswith("FMU ")
        }
        for table in data["sections"]["accuracy"]["tables"]
        if table["title"] != "every point"
    }
    return {"times": [{name: t[name] for name in kept} for t in data["targets"]], "costs": costs}


GROUPS: dict[str, Callable[..., Data]] = {
    "demo": demo,
    "errors": errors,
    "models": models,
    "cost": cost,
    "points": points,
    "motions": motions,
}
