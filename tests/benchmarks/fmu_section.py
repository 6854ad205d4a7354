"""Section fmu: the calls of a master on our FMUs and on the C FMU of the same physics."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from curvebound.study.timing import Probe, interleave, median, probe, ratio

from .cfmu import PLANTS, build_c_fmu
from .ours import Loaded
from .results import Section, Settings, Table, Target

__all__ = ["RECORDED", "fmu_section", "load_ours", "load_theirs"]

#: the six outputs that are read and recorded
RECORDED = {
    "BeadOnWire": (
        *("bead.x", "bead.y", "bead.vx", "bead.vy"),
        *("bead.angle", "bead.angular_velocity"),
    ),
    "ParabolaPendulum": (
        *("slider.u", "slider.u_rate", "pendulum.angle", "pendulum.angular_velocity"),
        *("pendulum.x", "pendulum.y"),
    ),
}

#: s, largest internal step
_STEP = 1e-3

_CALLS = (
    ("doStep, 1 internal step", 1.2),
    ("doStep, 10 internal steps", 1.2),
    ("getReal of 6, again", None),
    ("doStep + getReal of 6", None),
    ("simulate_fmu, per step", 1.35),
)


def load_ours(name: str, folder: Path) -> Loaded:
    """Build and extract our FMU `name` below `folder`."""
    from curvebound.fmi.build import build

    built = build(name, folder / "ours")
    return Loaded.extract(name, built.path, folder / f"{name}-ours")


def load_theirs(name: str, folder: Path) -> Loaded:
    """Build and extract the C FMU `name` below `folder`."""
    return Loaded.extract(name, build_c_fmu(name, folder / "c"), folder / f"{name}-c")


def _stepping(loaded: Loaded, internal: int, count: int, read: list[int]) -> Probe:
    """doStep over `internal` internal steps, and getReal of `read` after it if there are any."""
    slave = loaded.slave({"solver.step": _STEP})
    size = internal * _STEP
    done = [0]

    def run() -> None:
        step, get = slave.doStep, slave.getReal
        first = done[0]
        if read:
            for i in range(first, first + count):
                step(i * size, size)
                get(read)
        else:
            for i in range(first, first + count):
                step(i * size, size)
        done[0] = first + count

    return probe(run, count)


def _reading(loaded: Loaded, count: int, read: list[int]) -> Probe:
    slave = loaded.slave()
    slave.doStep(0.0, _STEP)

    def run() -> None:
        get = slave.getReal
        for _ in range(count):
            get(read)

    return probe(run, count)


def _simulating(loaded: Loaded, count: int) -> Probe:
    """simulate_fmu on an instance that exists, so that its set-up is a few calls of getReal."""
    from fmpy import simulate_fmu

    slave: Any = loaded.slave()
    recorded = RECORDED[loaded.name]

    def run() -> None:
        result = simulate_fmu(
            str(loaded.folder),
            model_description=loaded.description,
            fmu_instance=slave,
            start_values={"solver.step": _STEP},
            stop_time=count * _STEP,
            output_interval=_STEP,
            output=recorded,
            terminate=False,
        )
        assert len(result) == count + 1

    return probe(run, count, reset=slave.reset)


def fmu_section(settings: Settings, advance: Callable[[], object], folder: Path) -> Section:
    """Time the calls on both FMUs of both plants; scratch files go to `folder`."""
    section = Section("fmu", "FMU: microseconds per call through fmpy")
    probes: dict[str, Probe] = {}
    count = settings.choose(2000, 50)
    for name in PLANTS:
        for side, load in (("C", load_theirs), ("ours", load_ours)):
            loaded = load(name, folder)
            read = [loaded.references[variable] for variable in RECORDED[name]]
            one, ten, again, both, whole = (f"{name} {call} {side}" for call, _ in _CALLS)
            probes[one] = _stepping(loaded, 1, count, [])
            probes[ten] = _stepping(loaded, 10, count, [])
            probes[again] = _reading(loaded, count, read)
            probes[both] = _stepping(loaded, 1, count, read)
            probes[whole] = _simulating(loaded, count)
    # each call on the C FMU right beside the same call on ours
    ordered = {key: probes[key] for key in sorted(probes, key=lambda key: key.rpartition(" ")[0])}
    samples = interleave(ordered, settings.rounds, advance)
    for name in PLANTS:
        table = Table(name, ("call", "C FMU", "our FMU", "ours/C"), [])
        for call, limit in _CALLS:
            theirs, ours = samples[f"{name} {call} C"], samples[f"{name} {call} ours"]
            measured = ratio(ours, theirs)
            table.rows.append((call, median(theirs) * 1e6, median(ours) * 1e6, measured))
            if limit is not None:
                section.targets.append(Target(f"{call}, ours / C: {name}", limit, measured))
        section.tables.append(table)
    return section
