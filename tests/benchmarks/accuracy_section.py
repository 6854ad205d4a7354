"""Section accuracy: what an error costs, for our methods and for the general tools."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from curvebound.study.timing import Probe, interleave, probe

from .contenders import ANGLE, CARTESIAN, PENDULUM, REFERENCE_OF, Contender, Run
from .fmu_section import load_ours
from .ours import Loaded, compiled_kernel, leap_of_kernel, method_items
from .peers import decades, peers
from .references import DURATION, error_of
from .results import Cell, Section, Settings, Table, Target

__all__ = ["accuracy_section", "cost_at"]

_FMU = "FMU"
_KERNEL = "kernel"

#: system -> FMU and parameters
_SYSTEMS: dict[str, tuple[str, dict[str, float]]] = {
    ANGLE: ("BeadOnWire", {"model.formulation": 2}),
    CARTESIAN: ("BeadOnWire", {"model.formulation": 1, "constraint.stabilization": 3}),
    PENDULUM: ("ParabolaPendulum", {"model.fidelity": 2}),
}

#: steps (s) that divide references.DURATION
_STEPS = {
    "explicit_euler": (1e-2, 1e-3, 1e-4, 1e-5),
    "semi_implicit_euler": (1e-2, 1e-3, 1e-4, 1e-5),
    "rk4": (5e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "implicit": (5e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4),
}

#: errors for which the cost is read off
LEVELS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)

#: an integration that is as far off as this has failed
_FAILED = 0.1

#: one measured point: setting, error, cost (s of CPU time per simulated second)
Point = tuple[float, float, float]


def _ours(quick: bool, folder: Path) -> list[Contender]:
    """All our methods on all systems, through the built FMU and through the compiled kernel."""
    items = method_items()
    kernel = compiled_kernel()
    built = {name: load_ours(name, folder) for name in {name for name, _ in _SYSTEMS.values()}}
    found: list[Contender] = []
    for system, (name, chosen) in _SYSTEMS.items():
        loaded = built[name]
        for method, item in items.items():
            values = {**chosen, "solver.method": float(item)}
            if method == "adaptive":
                setting = "tolerance"
                settings = decades(-4, -6, 1) if quick else decades(-4, -15)
            elif method in _STEPS:
                setting = "step"
                settings = _STEPS[method][:2] if quick else _STEPS[method]
                # all of DURATION in one communication step
                values["solver.max_steps"] = 2e9
            else:
                continue  # exact needs the linear fidelity: there is nothing to trade

            def through_fmu(
                value: float,
                name: str = f"solver.{setting}",
                values: dict[str, float] = values,
                loaded: Loaded = loaded,
            ) -> Run:
                return loaded.leap(loaded.slave({**values, name: value}))

            def through_kernel(
                value: float,
                name: str = f"solver.{setting}",
                values: dict[str, float] = values,
                fmu: str = name,
            ) -> Run:
                return leap_of_kernel(kernel, fmu, {**values, name: value})

            found.append(Contender(_FMU, method, system, setting, settings, through_fmu))
            found.append(Contender(_KERNEL, method, system, setting, settings, through_kernel))
    return found


def cost_at(points: Sequence[Point], level: float) -> float | None:
    """Cost of an error of `level`, interpolated in logarithms; None if it is not reached.

    `points` go from coarse to fine. An error counts as reached at a setting only if all finer
    settings keep it, so that a lucky crossing of zero does not; failed integrations are left out.
    """
    kept: list[tuple[float, float]] = []
    worst = 0.0
    for _, error, cost in reversed(points):
        if error < _FAILED:
            worst = max(worst, error, 1e-17)
            kept.append((worst, cost))
    kept.reverse()  # errors now fall
    for i, (error, cost) in enumerate(kept):
        if error <= level:
            if i == 0:
                return cost
            before, cheaper = kept[i - 1]
            share = math.log(before / level) / math.log(before / error)
            return math.exp(math.log(cheaper) + share * math.log(cost / cheaper))
    return None


def _measure(
    contenders: list[Contender], rounds: int, advance: Callable[[], object]
) -> list[list[Point]]:
    """The points of each contender, from coarse to fine."""
    errors: dict[str, float] = {}
    probes: dict[str, Probe] = {}
    for i, contender in enumerate(contenders):
        for setting in contender.settings:
            run = contender.prepare(setting)
            key = f"{i} {setting!r}"
            probes[key] = probe(run.go, DURATION, reset=run.reset)
            run.reset()
            run.go()
            error = error_of(REFERENCE_OF[contender.system], run.state())
            errors[key] = error if math.isfinite(error) else math.inf
            advance()
    samples = interleave(probes, rounds, advance)
    # the least: what disturbs a run makes it slower, and an error is read off between two settings
    return [
        [(s, errors[f"{i} {s!r}"], min(samples[f"{i} {s!r}"])) for s in contender.settings]
        for i, contender in enumerate(contenders)
    ]


def _targets(system: str, costs: dict[tuple[str, float], float | None]) -> list[Target]:
    def over(a: tuple[str, float], b: tuple[str, float]) -> float | None:
        x, y = costs.get(a), costs.get(b)
        return x / y if x and y else None

    ours, heyoka, scipy = f"{_FMU} adaptive", "heyoka Taylor", "scipy DOP853"
    return [
        Target(f"adaptive / heyoka at 1e-8: {system}", 1.0, over((ours, 1e-8), (heyoka, 1e-8))),
        Target(
            f"scipy DOP853 / adaptive at 1e-8: {system}",
            100.0,
            over((scipy, 1e-8), (ours, 1e-8)),
            at_least=True,
        ),
        Target(f"adaptive / heyoka at 1e-12: {system}", 1.0, over((ours, 1e-12), (heyoka, 1e-12))),
    ]


def accuracy_section(settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    """Measure all contenders at all their settings; scratch files go to `folder`."""
    section = Section(
        "accuracy",
        "Accuracy for cost: CPU us per simulated second to an error at 10 s, least of the rounds",
    )
    others, section.notes = peers(settings.quick)
    contenders = [*_ours(settings.quick, folder), *others]
    points = _measure(contenders, settings.rounds, advance)
    every = Table(
        "every point", ("system", "tool", "method", "setting", "value", "error", "ms/s"), []
    )
    for system in _SYSTEMS:
        table = Table(system, ("tool and method", *(f"{x:.0e}" for x in LEVELS), "best"), [])
        costs: dict[tuple[str, float], float | None] = {}
        for contender, measured in zip(contenders, points, strict=True):
            if contender.system != system:
                continue
            row: list[Cell] = []
            for level in LEVELS:
                cost = costs[contender.name, level] = cost_at(measured, level)
                row.append(None if cost is None else cost * 1e6)
            table.rows.append((contender.name, *row, min(error for _, error, _ in measured)))
            every.rows.extend(
                (system, contender.tool, contender.method, contender.setting, s, error, cost * 1e3)
                for s, error, cost in measured
            )
            failed = [s for s, error, _ in measured if error >= _FAILED]
            if failed and contender.tool == "heyoka":
                listed = ", ".join(f"{s:.1e}" for s in failed)
                section.notes.append(f"{contender.name} fails on {system} at {listed}: left out")
        section.tables.append(table)
        section.targets += _targets(system, costs)
    section.tables.append(every)
    return section
