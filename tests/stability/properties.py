"""What the property tests share: points of the declared ranges, runs of them, and how many."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from curvebound.cosim.prepared import Prepared
from curvebound.cosim.results import RunFailed
from curvebound.cosim.scene import Scene
from curvebound.fmi.declaration import CHOICE, COUNT, INPUT, OUTPUT, PARAMETER, Variable
from curvebound.fmi.folder import find
from curvebound.study.reference.motion import Motion
from curvebound.study.stability.ranges import drawer
from curvebound.study.stability.ranges import sampled as sampled_system

Values = dict[str, Any]

FMUS = {"bead": "BeadOnWire", "pendulum": "ParabolaPendulum"}
EXPLICIT = ("explicit_euler", "semi_implicit_euler", "rk4")
NONLINEAR = (*EXPLICIT, "adaptive", "implicit")


def counts(few: int, many: int) -> pytest.MarkDecorator:
    """Parametrise `count`: examples of the default suite, and of the slow one."""
    return pytest.mark.parametrize("count", [few, pytest.param(many, marks=pytest.mark.slow)])


def holds(
    count: int,
    check: Callable[..., None],
    *given_: st.SearchStrategy[Any],
    refused: float = 1.0,
) -> None:
    """Check a property at `count` examples, the same in every run.

    refused: largest share of the calls of `run_or_none` that may give none.
    """
    _tries.clear()
    quiet = settings(
        max_examples=count,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    quiet(given(*given_)(check))()
    assert _tries[False] <= refused * _tries.total(), _tries


#: how many calls of `run_or_none` gave something, and how many nothing
_tries: Counter[bool] = Counter()


@cache
def variables(system: str) -> dict[str, Variable]:
    return {v.name: v for v in find(FMUS[system]).fmu().variables}


def of_kind(system: str, *kinds: str) -> list[str]:
    return [name for name, v in variables(system).items() if v.kind in kinds]


_ready: dict[str, Prepared] = {}


def plant(system: str) -> Prepared:
    """The system's FMU, and no other: of two, fmpy gives the messages of both to the last."""
    if system not in _ready:
        for other in _ready.values():
            other.close()
        _ready.clear()
        _ready[system] = _prepare(system)
    return _ready[system]


def _prepare(system: str) -> Prepared:
    scene = Scene(f"properties_{system}", stop_time=1.0, step=1.0)
    scene.add("plant", FMUS[system], {})
    scene.record(*(f"plant.{name}" for name in of_kind(system, OUTPUT, COUNT)))
    return scene.prepare()


def run(system: str, values: Values, step: float, count: int) -> dict[str, np.ndarray]:
    """`count` communication steps of `step` s; every output over time. Raises RunFailed."""
    start = {f"plant.{name}": value for name, value in values.items()}
    result = plant(system).run(start, stop_time=count * step, step=step)
    return {name: result[f"plant.{name}"] for name in of_kind(system, OUTPUT, COUNT)}


def run_or_none(
    system: str, values: Values, step: float, count: int
) -> dict[str, np.ndarray] | None:
    try:
        found = run(system, values, step, count)
    except RunFailed:
        found = None
    _tries[found is not None] += 1
    return found


def _plain(values: Values) -> Values:
    """Without angles that only a search for counterexamples would choose: they underflow."""
    return {k: 0.0 if not isinstance(v, str) and abs(v) < 1e-60 else v for k, v in values.items()}


@cache
def sampled(system: str) -> st.SearchStrategy[Values]:
    """Points of the ranges that the random sample covers."""
    return st.randoms(use_true_random=False).map(drawer(FMUS[system])).map(_plain)


def _whole(variable: Variable) -> st.SearchStrategy[float]:
    """Every float of the declared domain: half of them of usual size."""
    sizes = st.floats(-12.0, 12.0).map(lambda x: 10.0**x) | st.floats(
        math.log(5e-324), math.log(1.79e308)
    ).map(math.exp)
    sizes = sizes.filter(lambda x: x > 0.0)
    if variable.minimum is None:
        return st.just(0.0) | sizes | sizes.map(lambda x: -x)
    return sizes if variable.above else st.just(0.0) | sizes


def whole(system: str) -> st.SearchStrategy[Values]:
    """Parameters, start values and inputs of the whole declared domains, with every choice."""
    parts: dict[str, st.SearchStrategy[Any]] = {}
    for name, variable in variables(system).items():
        if variable.kind in (PARAMETER, INPUT):
            parts[name] = st.just(variable.start) | _whole(variable)
        elif variable.kind == CHOICE:
            assert variable.type is not None
            parts[name] = st.sampled_from([item for item, _ in variable.type.items])
    # `exact` is refused by all but the linear fidelity, of which there is a test elsewhere
    return st.fixed_dictionaries(parts).filter(
        lambda v: v["solver.method"] != "exact" or v.get("model.fidelity") == "linear"
    )


def rate(system: str, values: Values) -> float:
    """About the fastest rate (1/s) of the motion at its start, damping left out."""
    motion = Motion(sampled_system(FMUS[system])[1], values, damped=False)
    start = np.array(motion.start)[:, None]
    j = motion.slopes(np.zeros(1), start[:2], start[2:])[0, :, :, 0].ravel()
    slope = 2.0 * abs(values.get("parabola.coefficient_start", 0.0))
    found = max(
        math.sqrt(sum(abs(x) for x in (j[0], j[3])) + math.sqrt(abs(j[1] * j[2]))),
        abs(values.get("bead.angular_velocity_start", 0.0)),
        abs(values.get("pendulum.angular_velocity_start", 0.0)),
        slope * abs(values.get("slider.u_rate_start", 0.0)),
    )
    if system == "bead":
        field = math.hypot(
            values["gravity.x"] - values["wire.ax"] + values["bead.fx"] / values["bead.mass"],
            values["gravity.y"] - values["wire.ay"] + values["bead.fy"] / values["bead.mass"],
        )
        found = max(found, math.sqrt(field / values["wire.radius"]))
    else:
        m1, m2 = values["slider.mass"], values["pendulum.mass"]
        field = sum(
            abs(values[f"gravity.{axis}"] - values[f"parabola.a{axis}"])
            + abs(values[f"slider.f{axis}"]) / m1
            + abs(values[f"pendulum.f{axis}"]) / m2
            for axis in "xy"
        )
        # what it swings at once it has left a start across the field, where nothing pulls it back
        found = max(found, math.sqrt(field * (1.0 + m2 / m1) / values["pendulum.length"]))
    return max(found, 1e-6)
