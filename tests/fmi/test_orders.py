"""Observed orders of convergence, with errors and work bounded together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from harness import Instance
from solutions import SOLUTIONS

#: method -> order, counts of internal steps in 1 s, bound of the error times count^order,
#: least and most evaluations a step
METHODS = {
    "explicit_euler": (1, (1000, 2000, 4000, 8000), 50.0, 1.0, 1.0),
    "semi_implicit_euler": (1, (1000, 2000, 4000, 8000), 25.0, 1.0, 1.0),
    "rk4": (4, (100, 200, 400, 800), 300.0, 4.0, 4.0),
    "implicit": (4, (50, 100, 200, 400), 200.0, 2.0, 4.7),
}


@pytest.mark.parametrize("label", SOLUTIONS)
@pytest.mark.parametrize("method", METHODS)
def test_order(start: Callable[..., Instance], method: str, label: str) -> None:
    solution = SOLUTIONS[label]
    order, counts, bound, least, most = METHODS[method]
    errors = []
    for count in counts:
        settings = {"solver.method": method, "solver.step": 1.0 / count}
        instance = start(solution.fmu, {**solution.parameters, **settings})
        instance.step(1.0)
        errors.append(np.abs(np.subtract(instance.get(*solution.names), solution.at_1)).max())
        assert errors[-1] < bound / count**order
        steps, evaluations = instance.get("solver.steps", "solver.evaluations")
        assert steps == count
        assert least * count <= evaluations <= most * count
    observed = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert observed == pytest.approx(order, abs=0.15)
