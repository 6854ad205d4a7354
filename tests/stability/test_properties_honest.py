"""Anywhere in the declared domains: finite outputs, or a message, in bounded work."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import strategies as st
from properties import FMUS, counts, holds, run, whole

from curvebound.cosim.results import RunFailed

#: what a message must offer
REMEDY = re.compile(r"[:;,] (set|give|choose|reduce|raise|keep|use|rescale|or|shorten|start)\b")
MOST = 300
#: evaluations and Jacobians of the dearest try of a step: Newton's method from two guesses for
#: `implicit`; twelve sweeps of seven, or a stiff step, for `adaptive`
PER_TRY = 2 * 2 * 2 * 25

#: s
steps = st.floats(-12.0, 9.0).map(lambda x: 10.0**x) | st.floats(
    math.log(1e-300), math.log(1e300)
).map(math.exp)


@counts(12, 500)
@pytest.mark.parametrize("system", FMUS)
def test_finite_or_refused_in_bounded_work(system: str, count: int) -> None:
    def check(values: dict[str, float], step: float) -> None:
        values = {**values, "solver.max_steps": MOST}
        cause, recorded = "", {}
        try:
            recorded = run(system, values, step, 2)
        except RunFailed as failure:
            cause = failure.cause
            recorded = {name: failure.result.data[name] for name in failure.result.data.dtype.names}
        for column in recorded.values():
            assert np.isfinite(column).all()
        if cause:
            assert REMEDY.search(cause), cause
        else:
            assert recorded["solver.evaluations"][-1] <= 2 * MOST * PER_TRY

    holds(count, check, whole(system), steps)


@counts(6, 200)
@pytest.mark.parametrize("system", FMUS)
def test_the_same_calls_give_the_same_bits(system: str, count: int) -> None:
    def check(values: dict[str, float], step: float) -> None:
        values = {**values, "solver.max_steps": MOST}
        found = []
        for _ in range(2):
            try:
                found.append({k: v.tobytes() for k, v in run(system, values, step, 3).items()})
            except RunFailed as failure:
                found.append({"cause": failure.cause, "data": failure.result.data.tobytes()})
        assert found[0] == found[1]

    holds(count, check, whole(system), steps)
