"""Choose the cheapest setting that meets a scene's error bounds, and check it.

examples:
  curvebound tune bead_on_wire
  curvebound tune bead_on_wire --error 1e-9
  curvebound tune scenarios/mine.py --error plant.slider.u=1e-4 --frame-rate 30 --write

JSON has, for each scene, the choice as start values by path (`start`), `step` (s), `algorithm` and
`hold`, `cpu_per_second` (s of CPU time per simulated second), and `bounds` and largest `errors` by
path, in `units`.
"""

from __future__ import annotations

import argparse
import math
from typing import Any

from ..arguments import positive, setting
from ..numbers import plain, quantity
from ..output import console_of, hand_out
from ..progress import Progress

NAME = "tune"
HELP = "choose the cheapest setting that meets a scene's needs"
AS_JSON = True


def _bound(text: str) -> tuple[str, float]:
    path, equals, number = text.rpartition("=")
    try:
        value = float(number)
    except ValueError:
        value = 0.0
    if not 0.0 < value < math.inf or (equals and not path):
        raise argparse.ArgumentTypeError(
            f"{text!r} is neither a finite bound above zero nor component.variable=bound"
        )
    return path, value


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "scenes", metavar="SCENE", nargs="+", help="a .py or .ssp file, a scene's name, or all"
    )
    parser.add_argument(
        "--error",
        metavar="[PATH=]BOUND",
        type=_bound,
        action="append",
        default=[],
        help="largest error, of one output or of all (default: what the scene needs)",
    )
    parser.add_argument(
        "--budget", type=positive, metavar="S", help="CPU seconds per simulated one"
    )
    parser.add_argument("--frame-rate", type=positive, metavar="HZ", help="pictures per second")
    parser.add_argument(
        "--keep",
        metavar="PATH=ITEM",
        type=setting,
        action="append",
        default=[],
        help="a model or formulation that stays as given; may be repeated",
    )
    parser.add_argument(
        "--continuous",
        action="store_true",
        help="judge control and inputs as acting all the time, not held over the macro step",
    )
    parser.add_argument(
        "--limit",
        type=positive,
        default=5.0,
        metavar="S",
        help="CPU seconds of one run (default: 5)",
    )
    parser.add_argument("--write", action="store_true", help="put the choice into the script")


def run(options: argparse.Namespace) -> int:
    """Tune and print; exit status 1 where nothing fits, or a budget is not kept."""
    from ..cosim import scene_names
    from ..study.extras import require

    require("study")
    console = console_of(options)
    data: list[dict[str, Any]] = []
    names = scene_names() if options.scenes == ["all"] else options.scenes
    status = 0
    for name in names:
        status = max(status, _tune(options, name, console, data))
    hand_out(options, data)
    return status


def _tune(options: argparse.Namespace, name: str, console: Any, data: list[dict[str, Any]]) -> int:
    """Tune one scene, and append what was found to `data`."""
    from ..cosim import load_scene
    from ..cosim.system import port_of
    from ..errors import CurveboundError
    from ..study.settings import study_outputs
    from ..study.tune.script import choice_block, put_choice, script_of
    from ..study.tune.tuner import Tuner

    script = script_of(name) if options.write else None
    scene = load_scene(name)
    bounds = {path: bound for path, bound in scene.needs.errors.items() if bound > 0.0}
    given: dict[str, float] = {}
    for path, bound in options.error:
        if path in given:
            which = f" of {path}" if path else ""
            raise CurveboundError(f"Two bounds{which}: {given[path]:g} and {bound:g}; give one.")
        given[path] = bound
    paths = list(dict.fromkeys([*bounds, *(p for p in given if p)]))
    if "" in given:
        paths = paths or study_outputs(scene, scene.check())
        bounds = dict.fromkeys(paths, given.pop(""))
    bounds |= given
    if not bounds:
        raise CurveboundError(
            f"The scene {scene.name} does not say what error it allows: give a bound with "
            "--error 1e-6, or set `needs` in the scene."
        )
    tuner = Tuner(
        scene,
        paths,
        continuous=options.continuous,
        frame_rate=options.frame_rate,
        limit=options.limit,
        keep=dict(options.keep),
    )
    budget = options.budget if options.budget is not None else scene.needs.budget
    with Progress(f"tuning {scene.name}") as tell:
        try:
            choice = tuner.tune(bounds, budget=budget, progress=lambda text: tell(note=text))
        finally:
            tuner.close()
    known = tuner.space.system.units(map(port_of, bounds))
    units = {path: known.get(path, "1") for path in bounds}
    lines = _words(scene, bounds, units, choice, budget)
    if tuner.space.is_simpler:
        kept = ", ".join(f"{path}={item}" for path, item in tuner.space.best_model.items())
        lines.append(
            f"  Judged against {kept}, as kept: what that model itself is off by is not in it."
        )
    for line in lines:
        console.print(line, soft_wrap=not console.is_terminal)
    data.append(_as_data(scene, bounds, choice, tuner.space.start(choice.best.setting), units))
    if choice.chosen is None:
        return 1
    if script is not None:
        setting = choice.chosen.setting
        wanted = ", ".join(f"{path} within {bound:g}" for path, bound in bounds.items())
        block = choice_block(scene, tuner.space, setting, [wanted])
        put_choice(script, block)
        console.print(f"written into {script}")
    return 0 if choice.within_budget else 1


def _as_data(
    scene: Any,
    bounds: dict[str, float],
    choice: Any,
    start: dict[str, Any],
    units: dict[str, str],
) -> dict[str, Any]:
    best = choice.best
    return {
        "scene": scene.name,
        "bounds": bounds,
        "units": units,
        "fits": choice.chosen is not None,
        "within_budget": choice.within_budget,
        "setting": _setting(best),
        "start": start,
        "step": best.setting.step,
        "algorithm": best.setting.algorithm,
        "hold": best.setting.hold,
        "cpu_per_second": best.cpu,
        "errors": {path: verdict.worst for path, verdict in best.verdicts.items()},
        "sure": choice.sure,
        "runs": choice.runs,
        "judged_until": choice.until,
    }


def _words(
    scene: Any,
    bounds: dict[str, float],
    units: dict[str, str],
    choice: Any,
    budget: float | None,
) -> list[str]:
    best = choice.best
    allowed = {path: quantity(bound, units[path]) for path, bound in bounds.items()}
    lines = [f"[bold]{scene.name}[/]: " + ", ".join(f"{p} within {b}" for p, b in allowed.items())]
    if choice.chosen is None:
        lines.append(
            f"  Nothing fits. The nearest, {_setting(best)}, misses by {plain(best.seen)} times."
        )
        if choice.advice:
            lines.append(f"  What would: {choice.advice}.")
    else:
        lines.append(
            f"  {_setting(best)}: {quantity(best.cpu, 's')} of CPU time per simulated second"
        )
        for path, verdict in best.verdicts.items():
            lines.append(
                f"  {path}: error {quantity(verdict.worst, units[path])} "
                f"(bound {allowed[path]}), verified by a run"
            )
        around = "starts within 20 % of the scene's own"
        lines.append(
            f"  Over {around}, at most {plain(best.miss, 2)} of the bound is expected"
            if choice.sure
            else f"  Over the {best.starts} {around} that were tried, at most "
            f"{plain(best.seen, 2)} of the bound was seen; their errors spread too widely to "
            "expect it of every other"
        )
        lines[-1] += f" ({choice.runs} runs)."
        cheaper = choice.cheaper
        if cheaper is None:
            lines.append("  Nothing clearly cheaper was found: here the macro steps cost most.")
        else:
            lines.append(
                f"  The next cheaper, {_setting(cheaper)} at {quantity(cheaper.cpu, 's')}, misses "
                f"by {plain(cheaper.miss)} times."
            )
    if choice.until < scene.stop_time:
        lines.append(
            f"  Judged up to t = {quantity(choice.until, 's', 4)}: beyond, the motion amplifies "
            "even the reference's own uncertainty too much."
        )
    if not choice.within_budget and budget is not None:
        text = f"  That is {plain(best.cpu / budget)} times the budget of {quantity(budget, 's')}."
        if choice.affordable is not None:
            found = choice.affordable
            text += (
                f" Within it, the most accurate is {_setting(found)}, which misses the bounds by "
                f"{plain(found.miss)} times."
            )
        lines.append(text)
    return lines


def _setting(candidate: Any) -> str:
    setting = candidate.setting
    return f"{setting.label}, macro step {quantity(setting.step, 's')}" + (
        "" if setting.coupling == "gauss_seidel" else f", {setting.coupling}"
    )
