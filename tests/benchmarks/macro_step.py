"""What a macro step costs here and in other tools, side by side.

Takes a scene (default swaying_parabola), writes it as an SSP package, and runs that in every tool
that is installed, in turn, several times. Median microseconds per macro step, set-up excluded.
"""

from __future__ import annotations

import argparse
import platform
import tempfile
from pathlib import Path
from statistics import median

from curvebound.cosim.load import load_scene
from curvebound.cosim.prepared import Prepared
from curvebound.cosim.scene import Scene
from curvebound.cosim.ssp import write_ssp
from curvebound.errors import CurveboundError

from .ssp_peers import TOOLS, available, run_peer

__all__ = ["configure", "costs", "run"]


def costs(scene: Scene, steps: int, rounds: int) -> dict[str, float | str]:
    """Median microseconds per macro step by tool, or why there is no number."""
    scene = scene.copy()
    scene.stop_time = scene.start_time + steps * scene.step
    outputs = [".".join(port) for port in scene.check().recorded]
    times: dict[str, list[float]] = {}
    failures: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as folder:
        package = write_ssp(scene, Path(folder) / "scene.ssp")
        ours = {}
        for algorithm in ("gauss_seidel", "jacobi"):
            one = scene.copy()
            one.algorithm = algorithm
            ours[f"curvebound {algorithm}"] = Prepared(one)
        for _ in range(rounds):
            for name, prepared in ours.items():
                times.setdefault(name, []).append(prepared.run().stepping)
            for tool in TOOLS:
                if not available(tool):
                    failures[tool] = "not installed"
                elif tool not in failures:
                    try:
                        seconds, _ = run_peer(tool, package, scene.step, steps, outputs)
                        times.setdefault(tool, []).append(seconds)
                    except CurveboundError as error:
                        failures[tool] = str(error)
        for prepared in ours.values():
            prepared.close()
    result: dict[str, float | str] = {
        name: median(values) / steps * 1e6 for name, values in times.items()
    }
    return {**result, **failures}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", nargs="?", default="swaying_parabola")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=7)


def run(options: argparse.Namespace) -> int:
    """Print the table."""
    scene = load_scene(options.scene)
    recorded = len(scene.check().recorded)
    print(f"{scene.name}: {options.steps} macro steps, {recorded} recorded outputs, ", end="")
    print(f"median of {options.rounds} rounds")
    found = costs(scene, options.steps, options.rounds)
    reference = found.get("simulate_ssp")
    for name, cost in found.items():
        if isinstance(cost, str):
            print(f"  {name:24s} {cost}")
        else:
            share = f"{cost / reference:6.2f}" if isinstance(reference, float) else ""
            print(f"  {name:24s} {cost:8.1f} us per step {share} of simulate_ssp")
    print(f"  Python {platform.python_version()} on {platform.machine()}")
    return 0
