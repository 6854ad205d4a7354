"""What is said of measures, methods and settings: every number of it, from rows made up."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import spearmanr

from curvebound.study import starts
from curvebound.study.grid import divisions, tolerances
from curvebound.study.precision.lessons import (
    LEVELS,
    cheapest,
    crossings,
    lessons,
    order_of,
    pareto,
    ratio_of_forms,
    usable,
)
from curvebound.study.precision.live_measures import Measured, Statement, points, statement


def row(**changes: Any) -> dict[str, Any]:
    return {
        "purpose": "micro", "form": "angle", "method": "rk4", "size_is": "step", "size": 1e-3,
        "macro_step": 0.01, "cpu": 1e-4, "energy_residual": 6e-6, "kinetic": 3.0,
        "acceleration_error": 0.5, "amplitude": 2.0, "failure": "", "error": 1e-6,
        "numerical": 1e-6, "modelling": 0.0, "judged": True, **changes,
    }  # fmt: skip


# -- measures -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("measure", "changes", "said", "true"),
    [
        ("energy.residual", {}, 2e-6, 0.5e-6),
        ("solver.tolerance", {"size_is": "tolerance", "size": 1e-7}, 1e-7, 0.5e-6),
        ("model.acceleration_error", {"modelling": 0.4}, 0.5, 0.2),
        ("model.acceleration_error", {"modelling": 0.4, "purpose": "amplitude"}, 0.5, 0.2),
    ],
)
def test_said_and_true_are_relative(
    measure: str, changes: dict[str, Any], said: float, true: float
) -> None:
    (found,) = points(measure, {"here": [row(**changes)]})
    assert found == Measured("here", "angle", "rk4", pytest.approx(said), pytest.approx(true))


@pytest.mark.parametrize(
    ("measure", "changes"),
    [
        ("solver.tolerance", {}),
        ("energy.residual", {"purpose": "amplitude"}),
        ("energy.residual", {"kinetic": 0.0}),
        ("energy.residual", {"amplitude": 0.0}),
        ("energy.residual", {"numerical": 2.0}),
        ("energy.residual", {"numerical": 1.9e-13}),
        ("energy.residual", {"energy_residual": 2e-17}),
        ("energy.residual", {"energy_residual": math.inf}),
        ("model.acceleration_error", {}),
    ],
)
def test_what_says_nothing(measure: str, changes: dict[str, Any]) -> None:
    assert points(measure, {"here": [row(**changes)]}) == []


def test_the_numbers_of_trust() -> None:
    rng = np.random.default_rng(3)
    said = 10.0 ** rng.uniform(-9, -2, 40)
    factors = 10.0 ** rng.uniform(-1.0, 1.5, 40)
    every = [Measured("s", "f", "m", s, s * k) for s, k in zip(said, factors, strict=True)]
    found = statement("energy.residual", every)
    assert found is not None
    assert (found.measure, found.group, found.count) == ("energy.residual", "all", 40)
    assert found.median == pytest.approx(np.median(factors))
    assert [found.low, found.high] == pytest.approx(np.quantile(factors, [0.05, 0.95]))
    assert found.under == pytest.approx(np.mean(factors > 10.0))
    assert found.correlation == pytest.approx(spearmanr(said, said * factors).statistic)


def test_the_same_model_counts_once() -> None:
    every = [Measured("s", "f", m, 0.5, 0.2) for m in ("rk4", "adaptive")]
    for measure, count in (("model.acceleration_error", 1), ("energy.residual", 2)):
        found = statement(measure, [*every, Measured("other", "f", "rk4", 0.5, 0.2)])
        assert found is not None
        assert found.count == count + 1
        assert math.isnan(found.correlation)


@pytest.mark.parametrize(
    ("count", "spread", "under", "correlation", "largest", "words"),
    [
        (7, 2.0, 0.0, 1.0, 1.0, "too few runs to tell"),
        (8, 29.0, 0.2, 0.91, 50.0, "a measure of the error"),
        (8, 31.0, 0.0, 0.91, 1.0, "an upper bound in these runs"),
        (8, 29.0, 0.0, 0.89, 1.1, "never exceeded tenfold in these runs"),
        (8, 31.0, 0.0, 0.69, 1.0, "an upper bound in these runs, which does not tell"),
        (50, 31.0, 0.04, 0.71, 20.0, "mostly an upper bound, exceeded tenfold in 2 of 50 runs"),
        (50, 31.0, 0.06, 0.71, 20.0, "tells large errors from small ones, not their size"),
        (50, 31.0, 0.04, 0.69, 20.0, "a warning only: it can be small while"),
    ],
)
def test_the_verdict(
    count: int, spread: float, under: float, correlation: float, largest: float, words: str
) -> None:
    made = Statement("m", "all", count, 1.0, 0.1, 0.1 * spread, under, correlation, largest)
    assert made.verdict.startswith(words)
    assert made.sentence == (
        f"m: {made.verdict}. In nine of ten runs the true error is 0.1 to "
        f"{0.1 * spread:.2g} times what it says, in {under:.0%} more than ten times "
        f"({count} runs, rank correlation {correlation:.2f})."
    )


# -- methods --------------------------------------------------------------------------------------


def law(form: str, method: str, size: float, factor: float, order: float, cpu: float) -> Any:
    size_is = "tolerance" if method == "adaptive" else "step"
    error = factor * size**order
    return row(form=form, method=method, size=size, size_is=size_is, error=error,
               numerical=error, cpu=cpu)  # fmt: skip


ROWS = [
    *(law("angle", "rk4", 10.0**-n, 90.0, 4.0, 1e-6 * 10.0**n) for n in (1, 1.5, 2, 2.5, 3)),
    *(law("none", "rk4", 10.0**-n, 2700.0, 4.0, 2e-6 * 10.0**n) for n in (1.5, 2, 2.5, 3)),
    *(law("angle", "adaptive", 10.0**-n, 0.9, 1.25, 3e-4 + 1e-6 * n) for n in (2, 4, 6, 8)),
    row(form="linear", method="exact", size=None, error=0.03, numerical=4e-15, modelling=0.03,
        cpu=1e-7),
]  # fmt: skip


def test_orders_and_ratios() -> None:
    assert order_of(ROWS, "angle", "rk4") == pytest.approx(4.0)
    assert order_of(ROWS, "angle", "adaptive") == pytest.approx(1.25)
    assert order_of(ROWS, "none", "adaptive") is None
    assert ratio_of_forms(ROWS, "none", "angle", "rk4") == pytest.approx(30.0)
    assert ratio_of_forms(ROWS, "angle", "none", "rk4") == pytest.approx(1 / 30.0)
    assert ratio_of_forms(ROWS, "none", "angle", "adaptive") is None


def test_the_longest_macro_step_counts() -> None:
    """Where a micro step was run in several macro steps."""
    shorter = [{**r, "macro_step": 0.001, "numerical": 7.0 * r["numerical"]} for r in ROWS]
    assert ratio_of_forms([*ROWS, *shorter], "none", "angle", "rk4") == pytest.approx(30.0)
    mixed = [*ROWS, *(r for r in shorter if r["form"] == "none")]
    assert ratio_of_forms(mixed, "none", "angle", "rk4") == pytest.approx(30.0)


def test_every_sentence() -> None:
    assert lessons(ROWS) == [
        "The linear model itself is off by 0.03, however it is integrated: it meets no bound "
        "below that.",
        "At the same step of rk4, none has 30 times the error of angle.",
        "exact is free of numerical error, 4e-15 at macro steps of 10 ms: rounding.",
        "Numerical error (angle): rk4 order 4.00, adaptive order 1.25 in its tolerance.",
        "The cheapest: angle rk4 from 0.01 on; angle adaptive from 1e-8 on. "
        "No setting reaches 1e-12.",
    ]
    assert lessons([]) == []


def test_the_cheapest_at_each_level() -> None:
    found = dict(crossings(ROWS))
    assert list(found) == list(LEVELS) == [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12]
    chosen = {level: r and (r["method"], r["size"]) for level, r in found.items()}
    assert chosen[1e-2] == ("rk4", pytest.approx(1e-1))
    assert chosen[1e-4] == ("rk4", pytest.approx(10.0**-1.5))
    assert chosen[1e-6] == ("rk4", pytest.approx(1e-2))
    assert chosen[1e-8] == ("adaptive", pytest.approx(1e-8))
    assert chosen[1e-10] == ("adaptive", pytest.approx(1e-8))
    assert chosen[1e-12] is None


def test_the_front_leaves_out_what_is_not_clearly_better() -> None:
    made = [
        row(cpu=c, error=e, amplitude=9.0)
        for c, e in [(4, 0.8), (1, 1.0), (2, 0.89), (3, 0.85), (2, 0.95)]
    ]
    assert [(r["cpu"], r["error"]) for r in pareto(made)] == [(1, 1.0), (2, 0.89), (4, 0.8)]
    # an error of half the range is that of a result which stays in the middle, however cheap
    assert [r["cpu"] for r in pareto([*made, row(cpu=0.1, error=4.6, amplitude=9.0)])] == [1, 2, 4]
    small = {"amplitude.a": 9.0, "total.worst.a": 1.0, "amplitude.b": 1e-3, "total.worst.b": 5e-4}
    assert pareto([row(error=1.0, **small)]) == []
    best = cheapest(made, 0.89)
    assert best is not None
    assert best["cpu"] == 2
    assert cheapest(made, 0.7) is None
    bad = [row(failure="no"), row(error=math.inf), row(purpose="macro")]
    assert usable([*bad, made[0]]) == [made[0]]


# -- what is run ----------------------------------------------------------------------------------


def test_sizes_that_a_study_runs() -> None:
    assert divisions(True) == [1, 3, 10, 30, 100, 300]
    assert divisions(False)[:7] == [1, 2, 5, 10, 20, 50, 100]
    assert divisions(False)[-1] == 50000
    assert tolerances(True) == pytest.approx([1e-2, 1e-5, 1e-8, 1e-11, 1e-14])
    assert tolerances(False) == pytest.approx([10.0**-n for n in range(2, 15)])


@pytest.fixture
def box(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Two start values, 2 and -10, of which the second is held at -9."""
    monkeypatch.setattr(starts, "initial_values", lambda system: {"a": 2.0, "b": -10.0})
    monkeypatch.setattr(starts, "set_points", lambda system: {"b": -9.0})
    return SimpleNamespace()


def test_fresh_starts_fill_the_same_box(box: Any) -> None:
    found = starts.unseen(box, 0.2, 400)
    for path, centre, half in (("a", 2.0, 0.4), ("b", -10.0, 0.2)):
        inside = (found[path] - centre) / half
        assert np.abs(inside).max() <= 1.0
        assert np.mean(inside) == pytest.approx(0.0, abs=0.15)
        assert np.var(inside) == pytest.approx(1.0 / 3.0, abs=0.06)
