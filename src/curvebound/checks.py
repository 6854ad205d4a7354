"""What every system is held to, whoever wrote it: checks for pytest, or to be called as they are.

    from curvebound.checks import CHECKS

    @pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
    def test_system(check):
        check(FOLDER)

Each takes the folder of a system and raises AssertionError, which says what is wrong where.
"""

from __future__ import annotations

import functools
import math
import random
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .checking.changes import wrong_changes
from .checking.derivatives import wrong_derivatives
from .checking.points import model_anywhere, models, numbers_of, pushes
from .checking.rates import wrong_rates
from .cosim import Scene
from .cosim.fmu import Value, read_fmu
from .cosim.instance import Instance, Library, Log
from .fmi.build import build
from .fmi.cached import cached_fmu
from .fmi.compile import why_not
from .fmi.declaration import OUTPUT, PARAMETER, Fmu
from .fmi.folder import Folder
from .fmi.runtime import runtime, system_sources
from .mechanics.numeric import extended
from .study.settings import STEP_ORDERS
from .study.stability.sample import SampleSettings, run_sample
from .study.stability.sample_report import passes

__all__ = [
    "CHECKS",
    "changes_follow_outputs",
    "derivatives_follow_accelerations",
    "is_a_valid_fmu",
    "is_right_at_random_points",
    "keeps_the_balance_of_energy",
    "kernel_follows_mechanics",
    "methods_have_their_orders",
    "rates_follow_outputs",
    "runs_alike_compiled_and_interpreted",
    "saves_its_whole_state",
]

Columns = dict[str, NDArray[np.float64]]

#: steps a second from which orders are looked at: the fastest motion may need many
_COUNTS = (50, 200, 800, 3200)
#: states at which accelerations are compared, and how close they are, relative
_STATES, _CLOSE = 300, 1e-12
#: points of its ranges that are run
_POINTS = 200
#: an error below this is rounding
_NOISE = 3e-12


def is_a_valid_fmu(folder: Path | str) -> None:
    """fmpy's validation finds nothing in the FMU."""
    from fmpy.validation import validate_fmu

    problems = validate_fmu(str(cached_fmu(_of(folder))))
    assert not problems, "\n".join(problems)


def kernel_follows_mechanics(folder: Path | str) -> None:
    """The kernel's accelerations are those that follow from mechanics.py, to 1e-12."""
    system = _of(folder)
    if not system.has("mechanics"):
        return
    derived, fmu = system.derived(), system.fmu()
    rng = random.Random(1)
    for label, choices in models(fmu):
        numbers = numbers_of(fmu, choices)
        if derived.has_constraint and numbers["model.formulation"] == 1:
            continue  # its state is Cartesian
        linear = derived.has_linear and numbers.get("model.fidelity") == 1
        accelerations = derived.function("linear_accelerations" if linear else "accelerations")
        for _ in range(_STATES):
            model, values = model_anywhere(fmu, system.module("kernel").model, numbers, rng)
            symbols = derived.at(extended, {n: extended.number(x) for n, x in values.items()})
            model.acceleration(0.0, model.q0, model.q1, model.v0, model.v1)
            got = (model.a0, model.a1)[: len(derived.coordinates)]
            true = [float(a) for a in accelerations(extended, symbols)]
            size = max(map(abs, true))
            for name, a, b in zip(derived.coordinates, got, true, strict=True):
                assert abs(a - b) <= _CLOSE * size, (
                    f"{label}the acceleration of {name} is {a!r} in the kernel, but {b!r} follows "
                    f"from mechanics.py, at {values}"
                )


def derivatives_follow_accelerations(folder: Path | str) -> None:
    """What the kernel's jacobian() sets are its accelerations and their derivatives, to 1e-6."""
    _nothing_wrong(folder, wrong_derivatives)


def changes_follow_outputs(folder: Path | str) -> None:
    """What fmi2GetDirectionalDerivative gives are the slopes of the outputs over the inputs."""
    _nothing_wrong(folder, wrong_changes)


def rates_follow_outputs(folder: Path | str) -> None:
    """Outputs named as the rates of others, as fmi2GetRealOutputDerivatives takes them, are these.

    bead.vx of bead.x, ball.angular_velocity of ball.angle, bead.u_rate of bead.u.
    """
    _nothing_wrong(folder, wrong_rates)


def keeps_the_balance_of_energy(folder: Path | str) -> None:
    """energy.residual stays at rounding while the system is driven and damped."""
    system = _of(folder)
    fmu = system.fmu()
    names = {v.name for v in fmu.variables}
    if "energy.residual" not in names:
        return
    built = cached_fmu(system)
    for label, choices in models(fmu):
        start = {**_damped(fmu), **choices, "solver.method": "adaptive", "solver.tolerance": 1e-10}
        got = _run(built, start, pushes(fmu))
        moved = got["energy.kinetic"].max() + np.ptp(got["energy.potential"])
        residual = float(np.abs(got["energy.residual"]).max())
        assert residual <= 1e-7 * max(moved, 1e-3), (
            f"{label}energy.residual reaches {residual:.2g} J where {moved:.2g} J move: power and "
            "energies do not belong to the same equations of motion"
        )


def methods_have_their_orders(folder: Path | str) -> None:
    """The error of the state falls with the step as the order of each method says."""
    system = _of(folder)
    fmu = system.fmu()
    states = _states(fmu)
    if "solver.method" not in {v.name for v in fmu.variables}:
        return
    built = cached_fmu(system)
    for label, choices in models(fmu):
        start = {**_damped(fmu), **choices}
        precise = {**start, "solver.method": "adaptive", "solver.tolerance": 1e-13}
        exact = _final(built, precise, states)
        for method, order in STEP_ORDERS.items():
            tried: list[str] = []
            for count in _COUNTS:
                errors = [
                    _error(built, {**start, "solver.method": method}, steps, states, exact)
                    for steps in (count, 2 * count)
                ]
                if errors[1] < _NOISE:
                    break
                observed = math.log2(errors[0] / errors[1])
                tried.append(f"{observed:.2f} at {count} steps a second")
                if abs(observed - order) < 0.3:
                    break
            else:
                raise AssertionError(
                    f"{label}{method} has order {order}, but its error falls as {', '.join(tried)}"
                )


def saves_its_whole_state(folder: Path | str) -> None:
    """A step that is taken back and taken again gives the same bits."""
    system = _of(folder)
    fmu = system.fmu()
    described = read_fmu(cached_fmu(system))
    library = Library(described)
    outputs = [v.name for v in fmu.ordered() if v.kind == OUTPUT]
    methods = ["adaptive", *STEP_ORDERS] if "solver.method" in described.variables else [""]
    for label, choices in models(fmu):
        for method in methods:
            instance = Instance("system", library, Log())
            start = {**_damped(fmu), **choices, **({"solver.method": method} if method else {})}
            typed = {name: described.variables[name].value(x) for name, x in start.items()}
            instance.initialize(typed.items(), None, 0.0, 1.0)
            instance.call("ExitInitializationMode")
            _steps(instance, fmu, 0, 7)
            instance.save()
            first = _steps(instance, fmu, 7, 12, outputs)
            instance.restore()
            again = _steps(instance, fmu, 7, 12, outputs)
            instance.free()
            wrong = [name for name in outputs if first[name] != again[name]]
            assert not wrong, f"{label}{method}: {', '.join(wrong)} differ after fmi2SetFMUstate"


def is_right_at_random_points(folder: Path | str) -> None:
    """Random points of its ranges, run with `adaptive`, are accurate or say that they are not.

    Those of `curvebound sample`, judged by references in extended precision.
    """
    system = _of(folder)
    if not system.has("mechanics"):
        return
    outcomes = run_sample(SampleSettings(system.path, fmu=cached_fmu(system)), _POINTS, 1)
    bad = [one for one in outcomes if one.verdict != "accurate"]
    assert passes(outcomes), (
        f"{len(bad)} of {len(outcomes)} points of its ranges are not accurate; fmu.py may declare "
        "other ranges. The first:\n"
        + "\n".join(
            f"{one.verdict}, {one.message or f'error {one.error:.1e} of {one.output}'}, "
            f"at {one.point.values}"
            for one in bad[:3]
        )
    )


def runs_alike_compiled_and_interpreted(folder: Path | str) -> None:
    """The compiled kernel gives the same bits as the interpreted one."""
    system = _of(folder)
    if why_not(system_sources(system, runtime())):
        return
    fmu = system.fmu()
    plant = "solver.method" in {v.name for v in fmu.variables}
    built, interpreted = cached_fmu(system), _interpreted(system)
    for label, choices in models(fmu):
        for method in ["adaptive", *STEP_ORDERS] if plant else [""]:
            start = {**_damped(fmu), **choices, **({"solver.method": method} if method else {})}
            one = _run(built, start, pushes(fmu), stop=0.3)
            other = _run(interpreted, start, pushes(fmu), stop=0.3)
            wrong = [name for name in one if not np.array_equal(one[name], other[name])]
            assert not wrong, f"{label}{method}: {', '.join(wrong)} differ"


#: all of the above
CHECKS: tuple[Callable[[Path | str], None], ...] = (
    is_a_valid_fmu,
    kernel_follows_mechanics,
    derivatives_follow_accelerations,
    changes_follow_outputs,
    rates_follow_outputs,
    keeps_the_balance_of_energy,
    methods_have_their_orders,
    saves_its_whole_state,
    is_right_at_random_points,
    runs_alike_compiled_and_interpreted,
)


def _nothing_wrong(
    folder: Path | str, wrong: Callable[[Fmu, dict[str, int], random.Random, int], str]
) -> None:
    """Each model of a system at random points; wrong: says what is, or ''."""
    fmu = _of(folder).fmu()
    rng = random.Random(1)
    for label, choices in models(fmu):
        found = wrong(fmu, numbers_of(fmu, choices), rng, _STATES)
        assert not found, f"{label}{found}"


def _of(folder: Path | str) -> Folder:
    return Folder(Path(folder).resolve())


@functools.cache
def _interpreted(folder: Folder) -> Path:
    """Its FMU without a compiled kernel, once in a process."""
    place = tempfile.TemporaryDirectory(prefix="curvebound-checks-")
    _kept.append(place)
    return build(folder, Path(place.name), compiled=False).path


_kept: list[tempfile.TemporaryDirectory[str]] = []


def _states(fmu: Fmu) -> list[str]:
    """The outputs with a start value."""
    names = {v.name for v in fmu.variables if v.kind == PARAMETER}
    return [v.name for v in fmu.ordered() if v.kind == OUTPUT and f"{v.name}_start" in names]


def _damped(fmu: Fmu) -> dict[str, Value]:
    """Damping, where there is any."""
    return {
        v.name: 0.1
        for v in fmu.variables
        if v.kind == PARAMETER and v.unit in ("N.s/m", "N.m.s/rad") and v.start == 0.0
    }


def _run(
    fmu: Path,
    start: Mapping[str, Value],
    inputs: Mapping[str, Callable[[float], float]] | None = None,
    *,
    stop: float = 2.0,
    step: float = 0.02,
) -> Columns:
    """All outputs of a run, by name."""
    scene = Scene("check", stop_time=stop, step=step)
    scene.add("system", fmu, start)
    for name, signal in (inputs or {}).items():
        scene.input(f"system.{name}", signal)
    result = scene.run()
    return {
        name.removeprefix("system."): np.asarray(result[name], dtype=np.float64)
        for name in result.names
    }


def _final(fmu: Path, start: Mapping[str, Value], states: list[str]) -> list[float]:
    """The states after 1 s in one communication step."""
    got = _run(fmu, start, stop=1.0, step=1.0)
    return [float(got[name][-1]) for name in states]


def _error(
    fmu: Path,
    start: Mapping[str, Value],
    steps: int,
    states: list[str],
    exact: list[float],
) -> float:
    """The largest error of the states after 1 s in so many internal steps."""
    got = _final(fmu, {**start, "solver.step": 1.0 / steps}, states)
    return max(abs(a - b) for a, b in zip(got, exact, strict=True))


def _steps(
    instance: Instance, fmu: Fmu, first: int, end: int, outputs: Iterable[str] = ()
) -> dict[str, list[float]]:
    """Take the communication steps first ... end - 1 of 0.05 s; outputs after each."""
    from ctypes import c_double, c_int

    got: dict[str, list[float]] = {name: [] for name in outputs}
    for number in range(first, end):
        for name, signal in pushes(fmu).items():
            instance.set(name, signal(0.05 * number))
        instance.call("DoStep", c_double(0.05 * number), c_double(0.05), c_int(1))
        for name, values in got.items():
            reference = instance.fmu.variables[name].reference
            values += instance.slave.getReal([reference])
    return got
