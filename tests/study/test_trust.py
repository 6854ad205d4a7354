"""What is stated of the live measures, from rows whose errors are known by construction."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from curvebound.cosim import load_scene
from curvebound.study.data_files import write_json
from curvebound.study.precision.amplitudes import FACTORS, amplitude_rows
from curvebound.study.precision.lessons import crossings, equals, lessons, order_of, spread_of
from curvebound.study.precision.live_measures import points, statement
from curvebound.study.precision.page import study_page
from curvebound.study.precision.repeated_timing import time_again
from curvebound.study.precision.report import write_overview
from curvebound.study.precision.study import Study
from curvebound.study.runner import Runner
from curvebound.study.settings import Setting


def row(size: float, error: float, **changes: Any) -> dict[str, Any]:
    """A row of adaptive at tolerance `size` with an output that ranges over 2."""
    return {
        "purpose": "micro", "form": "angle", "method": "adaptive", "size_is": "tolerance",
        "size": size, "macro_step": 0.01, "algorithm": "gauss_seidel", "cpu": 1e-4 / size**0.1,
        "evaluations": 10, "steps": 1, "energy_residual": 3.0 * size, "kinetic": 3.0,
        "drift": None, "acceleration_error": None, "amplitude": 2.0, "failure": "",
        "error": error, "numerical": error, "modelling": 0.0, "judged": True, "judged_until": 10.0,
        **changes,
    }  # fmt: skip


SIZES = [10.0**-n for n in range(2, 12)]


def stated(measure: str, rows: list[dict[str, Any]]) -> Any:
    return statement(measure, points(measure, {"scene": rows}))


def test_a_measure_that_follows_the_error_is_called_one() -> None:
    said = stated("solver.tolerance", [row(size, 2.0 * 0.5 * size) for size in SIZES])
    assert (said.count, said.median) == (10, pytest.approx(0.5))
    assert said.correlation == pytest.approx(1.0)
    assert said.verdict == "a measure of the error"
    assert "10 runs" in said.sentence


def test_a_measure_that_overstates_by_more_and_more_is_an_upper_bound() -> None:
    said = stated("solver.tolerance", [row(size, 2.0 * size**1.4) for size in SIZES[:8]])
    assert said.under == 0.0
    assert said.verdict.startswith("an upper bound")


def test_a_measure_that_misses_large_errors_is_a_warning_only() -> None:
    errors = np.random.default_rng(1).permutation([10.0**-n for n in range(1, 11)])
    rows = [row(size, float(e)) for size, e in zip(SIZES, errors, strict=True)]
    assert stated("energy.residual", rows).verdict.startswith("a warning only")


def test_a_measure_that_was_never_exceeded_is_not_said_to_be() -> None:
    """Errors without order below what is said: a bound, though none that tells them apart."""
    errors = np.random.default_rng(1).permutation([10.0**-n for n in range(5, 15)])
    rows = [row(1e-3 * (1 + i), float(e)) for i, e in enumerate(errors)]
    said = stated("energy.residual", rows)
    assert said.under == 0.0
    assert "can be small" not in said.verdict
    assert said.verdict.startswith("an upper bound in these runs, which does not tell")


def test_the_runs_that_exceeded_a_measure_are_counted() -> None:
    rows = [row(size, 2.0 * size) for size in SIZES] + [row(1e-9, 0.1), row(1e-8, 0.2)]
    assert "in 2 of 12 runs" in stated("energy.residual", rows).verdict


def test_settings_that_timing_does_not_tell_apart_are_called_equal() -> None:
    rows = [
        row(1e-4, 1e-5, cpu=1.0, cpu_low=0.9, cpu_high=1.2, key="a"),
        row(1e-4, 1e-5, cpu=1.1, cpu_low=1.0, cpu_high=1.4, key="b", method="rk4", size_is="step"),
        row(1e-4, 1e-5, cpu=1.9, cpu_low=1.8, cpu_high=2.0, key="c", method="implicit"),
    ]
    assert [r["method"] for r in equals(rows, 1e-4)] == ["rk4"]
    assert any("angle adaptive or angle rk4 from" in text for text in lessons(rows))
    assert spread_of(rows[0]) == "1 s (900 ms to 1.2 s)"


def test_what_is_near_the_cheapest_is_timed_again_in_turns() -> None:
    rows = [
        row(1e-4, 1e-5, cpu=cost, key=key) for key, cost in (("a", 1.0), ("b", 1.4), ("c", 9.0))
    ]
    turns: list[str] = []

    class Timer:
        def cost(self, setting: str, *, runs: int, enough: float) -> float:
            turns.append(setting)
            return 2.0 if setting == "a" else 1.5

    again = time_again(rows, {key: key for key in "abc"}, Timer())  # type: ignore[arg-type,misc]
    assert turns[:4] == ["a", "b", "a", "b"]
    assert [r["key"] for r in again] == ["a", "b"]
    assert (rows[0]["cpu"], rows[0]["cpu_low"], rows[0]["cpu_high"]) == (2.0, 1.0, 2.0)
    assert time_again(rows, {key: key for key in "abc"}, Timer()) == []  # type: ignore[arg-type]


def test_failures_are_listed_with_what_the_fmu_said(tmp_path: Path) -> None:
    failed = [
        row(
            size,
            math.inf,
            failure=f"failed at t = {size}: wire.radius is 0: give more",
            key=str(size),
        )
        for size in SIZES
    ]
    other = row(1e-3, math.inf, failure="another <fault>", key="x")
    page = study_page(
        tmp_path / "index.html", name="s", description="", rows=[row(1e-3, 1e-3), *failed, other],
        references=[], paths=["a.b"], unit="m", complete=True, statements=[], footer="",
    ).read_text()  # fmt: skip
    assert "wire.radius is 0: give more" in page
    assert "another &lt;fault&gt;" in page
    assert f"<td class=n>{len(failed)}</td>" in page


def test_what_was_not_judged_failed_or_is_rounding_says_nothing() -> None:
    rows = [
        row(1e-3, 1e-3, judged=False), row(1e-3, 1e-3, failure="no"), row(1e-3, 1e-14),
        row(1e-3, math.inf), row(1e-3, 1e-3, purpose="macro"),
    ]  # fmt: skip
    assert stated("solver.tolerance", rows) is None


def test_the_overview_states_each_measure_and_names_the_cheapest(tmp_path: Path) -> None:
    rows = [row(size, size) for size in SIZES]
    for name in ("one", "two"):
        data = {"scene": name, "description": "<b>", "rows": [*rows, row(1e-3, math.inf)]}
        write_json(data, tmp_path / name / "study.json")
    page, sentences = write_overview(tmp_path, plots=False)
    text = page.read_text()
    assert [s.partition(":")[0] for s in sentences] == ["solver.tolerance", "energy.residual"]
    assert all(sentence.split(".")[0] in text for sentence in sentences)
    assert "<b>" not in text.replace("<b>Unfinished", "")
    assert write_overview(tmp_path / "empty", plots=False) is None


def test_the_order_is_that_above_the_rounding() -> None:
    """Below 1e-13 more steps bring more rounding, which is no law of the method."""
    rows = [
        row(size, size**4 + 1e-17 / size, method="rk4", size_is="step")
        for size in [10.0 ** (-n / 2) for n in range(2, 12)]
    ]
    assert order_of(rows, "angle", "rk4") == pytest.approx(4.0, abs=0.05)


def test_lessons_name_order_and_cheapest() -> None:
    rows = [row(size, size**1.2) for size in SIZES]
    assert order_of(rows, "angle", "adaptive") == pytest.approx(1.2)
    assert dict(crossings(rows))[1e-4]["size"] == pytest.approx(1e-4)
    assert any("angle adaptive from" in text for text in lessons(rows))


def test_a_run_is_judged_by_every_point_up_to_many(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene("bead_on_wire")
    scene.stop_time = 1.0
    study = Study.of(scene)
    setting = Setting((), "rk4", 0.1, 0.1, "gauss_seidel")
    with Runner(scene, study.space, study.paths) as runner:
        assert runner.glance(setting).times == pytest.approx(np.arange(11) / 10.0, abs=1e-15)
        monkeypatch.setattr("curvebound.study.runner._KEPT", 9)
        every_other = runner.glance(setting).times
        assert every_other == pytest.approx(np.arange(0, 11, 2) / 10.0, abs=1e-15)
        monkeypatch.setattr("curvebound.study.runner._KEPT", 10)
        assert len(runner.glance(setting).times) == 11


def test_a_simpler_model_is_judged_at_motions_of_many_sizes() -> None:
    """The error of the linear model relative to its motion falls with the square of its size."""
    scene = load_scene("pendulum_small")
    scene.stop_time = 1.0
    study = Study.of(scene)
    with Runner(scene, study.space, study.paths) as runner:
        rows = list(amplitude_rows(runner, {}))
    assert [r["factor"] for r in rows] == list(FACTORS)
    relative = [r["modelling"] / r["amplitude"] for r in rows]
    assert relative[1] / relative[0] == pytest.approx(9.0, rel=0.05)
    assert rows[1]["acceleration_error"] / rows[0]["acceleration_error"] == pytest.approx(
        9, rel=0.1
    )
    assert len(points("model.acceleration_error", {"scene": rows})) == len(FACTORS)
    assert points("solver.tolerance", {"scene": rows}) == []


def test_a_motion_that_feedback_holds_upright_is_not_made_smaller() -> None:
    scene = load_scene("inverted_balance")
    study = Study.of(scene)
    with Runner(scene, study.space, study.paths) as runner:
        assert not list(amplitude_rows(runner, {}))
