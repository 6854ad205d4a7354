"""Section kernel: one RK4 step of each model, in C, compiled and interpreted."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any, NamedTuple

from curvebound.study.timing import Probe, interleave, median, probe, ratio

from . import native
from .ours import Kernel, compiled_kernel, interpreted_kernel
from .results import Section, Settings, Table, Target

__all__ = ["kernel_section"]

#: s
_STEP = 1e-3
_RK4 = 3


class _Case(NamedTuple):
    """A model: its FMU and parameters, the C function with its first arguments, and the start."""

    title: str
    fmu: str
    values: dict[str, float]
    function: str
    arguments: tuple[Any, ...]
    start: str
    #: most that compiled over C may be, where that is held
    limit: float | None


def _cases() -> list[_Case]:
    bead, pendulum, linear = native.kernel_systems()
    wire, parabola = "BeadOnWire", "ParabolaPendulum"
    return [
        _Case(
            "bead, Cartesian, projection",
            wire,
            {"constraint.stabilization": 3},
            "run_bead_cartesian",
            (ctypes.byref(bead), 1),
            "cartesian",
            1.2,
        ),
        _Case(
            "bead, Cartesian",
            wire,
            {"constraint.stabilization": 1},
            "run_bead_cartesian",
            (ctypes.byref(bead), 0),
            "cartesian",
            None,
        ),
        _Case(
            "bead, angle",
            wire,
            {"model.formulation": 2},
            "run_bead_angle",
            (ctypes.byref(bead),),
            "angle",
            None,
        ),
        _Case(
            "pendulum, nonlinear",
            parabola,
            {"model.fidelity": 2},
            "run_pendulum_nonlinear",
            (ctypes.byref(pendulum),),
            "pendulum",
            1.2,
        ),
        _Case(
            "pendulum, linear",
            parabola,
            {"model.fidelity": 1},
            "run_pendulum_linear",
            (ctypes.byref(linear),),
            "pendulum",
            1.4,
        ),
    ]


def _c_probe(library: ctypes.CDLL, case: _Case, count: int) -> Probe:
    state = native.State()
    function = getattr(library, case.function)

    def reset() -> None:
        state.q0, state.q1, state.v0, state.v1 = native.STARTS[case.start]

    def run() -> None:
        function(*case.arguments, _STEP, count, ctypes.byref(state))

    return probe(run, count, reset=reset)


def _python_probe(kernel: Kernel, case: _Case, count: int) -> Probe:
    model = kernel.system(case.fmu, case.values)
    method = kernel.method(_RK4)
    start = model.get_state()
    duration = count * _STEP
    run: Callable[[], object] = lambda: method.advance(model, duration, count, 1e-6, 10**9)  # noqa: E731
    return probe(run, count, reset=lambda: model.set_state(start))


def kernel_section(settings: Settings, advance: Callable[[], object]) -> Section:
    """Time RK4 steps in all three forms; `advance` is called after each measurement."""
    section = Section("kernel", "Kernel: ns per RK4 step")
    library = native.kernel()
    compiled, interpreted = compiled_kernel(), interpreted_kernel()
    cases = _cases()
    probes: dict[str, Probe] = {}
    for case in cases:
        count = settings.choose(20000, 500)
        probes[f"{case.title} C"] = _c_probe(library, case, count)
        probes[f"{case.title} compiled"] = _python_probe(compiled, case, count)
        probes[f"{case.title} interpreted"] = _python_probe(
            interpreted, case, settings.choose(1000, 100)
        )
    samples = interleave(probes, settings.rounds, advance)
    table = Table("", ("model", "C", "compiled", "interpreted", "compiled/C"), [])
    for case in cases:
        times = [samples[f"{case.title} {form}"] for form in ("C", "compiled", "interpreted")]
        measured = ratio(times[1], times[0])
        table.rows.append((case.title, *(median(each) * 1e9 for each in times), measured))
        if case.limit is not None:
            what = f"RK4 step, compiled / C: {case.title}"
            section.targets.append(Target(what, case.limit, measured))
    section.tables.append(table)
    return section
