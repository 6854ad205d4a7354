"""Results do not depend on how a run is cut into communication steps."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest
from harness import Extracted, final, simulated
from solutions import SOLUTIONS

#: method -> internal step (s), bound of its error at 10 s
METHODS = {
    "explicit_euler": (1e-4, 0.5),
    "semi_implicit_euler": (1e-4, 0.2),
    "rk4": (1e-3, 5e-8),
    "adaptive": (1e-3, 1e-8),
    "implicit": (1e-3, 5e-8),
    "exact": (1e-3, 1e-12),
}


def random_ends(seed: int, longest: float) -> list[float]:
    """Communication points up to 10 s with steps of random length."""
    draw = random.Random(seed)
    ends = [0.0]
    while ends[-1] < 10.0:
        ends.append(min(10.0, ends[-1] + longest * draw.random()))
    return ends[1:]


CUTS = {
    "steps of 0.01 s": [i * 0.01 for i in range(1, 1001)],
    "one step": [10.0],
    "random steps": random_ends(1, 0.5),
    "short random steps": random_ends(2, 0.01),
}


@pytest.mark.parametrize(
    ("method", "label"),
    [(m, label) for m in METHODS for label in SOLUTIONS if m != "exact" or label == "linear"],
)
def test_cuts_agree(start, method: str, label: str) -> None:
    solution = SOLUTIONS[label]
    step, bound = METHODS[method]
    parameters = {"solver.method": method, "solver.step": step, "solver.tolerance": 1e-10}
    errors = {}
    for cut, ends in CUTS.items():
        instance = start(solution.fmu, {**solution.parameters, **parameters})
        for end in ends:
            instance.step(end - instance.time)
            instance.time = end
        pairs = zip(instance.get(*solution.names), solution.at_10, strict=True)
        errors[cut] = max(abs(value - exact) for value, exact in pairs)
        assert instance.errors == []
        if method not in ("adaptive", "exact") and cut in ("steps of 0.01 s", "one step"):
            assert instance["solver.steps"] == round(10.0 / step)
    # nothing holds the unstabilised bead on the wire: errors grow ten times as fast
    assert max(errors.values()) < (10.0 * bound if label == "none" else bound)
    if method != "adaptive":
        # cutting adds no error: it can only make internal steps smaller
        assert max(errors.values()) < 1.1 * errors["one step"] + 2e-12


@pytest.mark.parametrize("label", SOLUTIONS)
@pytest.mark.parametrize("method", ["rk4", "adaptive", "implicit"])
def test_a_tiny_step_between_does_no_harm(start, method: str, label: str) -> None:
    """What a method carries from step to step is of no use after a step so much shorter."""
    solution = SOLUTIONS[label]
    parameters = {"solver.method": method, "solver.step": 1e-3, "solver.tolerance": 1e-10}
    for tiny in (1e-3, 1e-7, 1e-12, 1e-15):
        instance = start(solution.fmu, {**solution.parameters, **parameters})
        instance.run(10, 0.05)
        instance.step(tiny)
        instance.step(0.5 - tiny)
        errors = [
            abs(value - exact)
            for value, exact in zip(instance.get(*solution.names), solution.at_1, strict=True)
        ]
        assert max(errors) < 1e-8
        assert instance["solver.evaluations"] < 10000


def counted(start, parameters: dict[str, float], ends: list[float], begin: float = 0.0) -> int:
    instance = start("BeadOnWire", parameters, start_time=begin)
    for end in ends:
        instance.step(end - instance.time)
        instance.time = end
    return instance["solver.steps"]


@pytest.mark.parametrize("begin", [0.0, 0.1, 1000.0, 86400.0])
def test_sixtieths_of_a_second_add_no_internal_step(start, begin: float) -> None:
    summed = [begin]
    for _ in range(600):
        summed.append(summed[-1] + 1.0 / 60.0)
    multiples = [begin + i / 60.0 for i in range(1, 601)]
    for per_step in (1, 2, 3, 7, 10):
        parameters = {"solver.step": 1.0 / (60.0 * per_step)}
        for ends in (summed[1:], multiples, [begin + 10.0]):
            assert counted(start, parameters, ends, begin) == 600 * per_step


@pytest.mark.parametrize(
    ("size", "step"),
    [(0.1, 0.01), (0.1, 1e-3), (0.01, 1e-3), (0.3, 0.1), (0.7, 0.1), (1.0 / 3.0, 1.0 / 30.0)],
)
def test_decimal_steps_add_none_either(start, size: float, step: float) -> None:
    per_step = round(size / step)
    parameters = {"solver.step": step}
    summed = [size]
    for _ in range(299):
        summed.append(summed[-1] + size)
    assert counted(start, parameters, summed) == 300 * per_step
    assert counted(start, parameters, [i * size for i in range(1, 301)]) == 300 * per_step


def test_a_step_that_really_is_longer_gets_one_more(start) -> None:
    assert counted(start, {"solver.step": 1e-3}, [0.01 * (1.0 + 1e-9)]) == 11
    assert counted(start, {"solver.step": 1e-3}, [0.0101]) == 11
    assert counted(start, {"solver.step": 1e-3}, [0.0099]) == 10
    assert counted(start, {"solver.step": 1.0}, [0.001]) == 1


def test_the_fewest_internal_steps_that_are_not_larger(start) -> None:
    ends = random_ends(3, 0.2)
    expected = 0
    for begin, end in zip([0.0, *ends], ends, strict=False):
        expected += math.ceil(Fraction(end - begin) / Fraction(1e-3))
    assert counted(start, {"solver.step": 1e-3}, ends) == expected


def test_simulate_fmu_with_sixtieths(extracted: dict[str, Extracted]) -> None:
    result = simulated(
        extracted["BeadOnWire"],
        {"solver.step": 1.0 / 60.0},
        ["solver.steps"],
        stop_time=100.0,
        interval=1.0 / 60.0,
    )
    assert final(result, ["solver.steps"]) == [6000]
