"""Long runs: growth of the errors as theory says, the A01 benchmark, very many steps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from benchmarks import long_runs
from benchmarks.__main__ import main
from benchmarks.endurance import INTERNAL, run_endurance
from benchmarks.iftomm import SETTINGS, position, run_one
from benchmarks.long_runs import METHODS, LongRun, period, run_long

mpmath = pytest.importorskip("mpmath")


def test_the_period_is_that_of_the_elliptic_integral() -> None:
    k = mpmath.sin(mpmath.mpf(long_runs.START) / 2)
    exact = 4 * mpmath.ellipk(k * k) / mpmath.sqrt(mpmath.mpf("9.81"))
    assert period() == pytest.approx(float(exact), rel=1e-14)


@pytest.mark.parametrize("method", ["semi_implicit_euler", "rk4", "implicit", "adaptive"])
def test_errors_grow_as_theory_says(method: str) -> None:
    one = run_long(method, 1000.0)
    assert one.message == ""
    assert one.periods == pytest.approx(1000.0, rel=0.05)
    assert one.as_expected, one
    assert one.phase < 0.01


def test_wrong_growth_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of RK4, judged as if it were symplectic; and a run that failed."""
    monkeypatch.setitem(long_runs.EXPECTED, "rk4", (0.0, 1.0))
    assert not run_long("rk4", 200.0).as_expected
    assert not LongRun("rk4", 10.0, message="it failed").as_expected


def test_the_benchmark_position() -> None:
    """From the horizontal at rest; at 2000 s as the benchmark gives it."""
    x, y = position([0.0, 2000.0]).T
    assert abs(x[0] - 1.0) < 1e-15
    assert abs(y[0]) < 1e-15
    assert x[1] == pytest.approx(-0.81460307, abs=5e-9)
    assert y[1] == pytest.approx(-0.58001883, abs=5e-9)
    # a swing obeys theta'' = -9.81 sin theta: second difference of the angle
    h = 1e-3
    points = position([0.7 - h, 0.7, 0.7 + h])
    angles = np.arctan2(points[:, 0], -points[:, 1])
    bend = (angles[0] - 2.0 * angles[1] + angles[2]) / (h * h)
    assert bend == pytest.approx(-9.81 * math.sin(angles[1]), abs=1e-4)


@pytest.mark.parametrize("number", [i for i, one in enumerate(SETTINGS) if one[3]])
def test_the_settings_to_use_hold_a_millionth(number: int) -> None:
    one = run_one(number, stop=40.0)
    assert one.good, one
    assert one.energy < 1e-8


def test_many_communication_steps() -> None:
    seen: list[int] = []
    one = run_endurance(20_000, seen.append)
    assert one.calls == seen[-1] == 20_000
    assert one.steps == INTERNAL * one.calls
    assert one.end == pytest.approx(2000.0)
    assert abs(one.residual) < 1e-3


def test_the_command_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["long", "--method", "implicit", "--periods", "1000"]) == 0
    said = capsys.readouterr().out
    assert "implicit" in said
    assert "yes" in said
    with pytest.raises(SystemExit):
        main(["long", "--periods", "3"])


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_ten_thousand_periods(method: str) -> None:
    one = run_long(method, 1e4)
    assert one.as_expected, one


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(SETTINGS)))
def test_two_thousand_seconds(number: int) -> None:
    one = run_one(number)
    assert one.good, one


@pytest.mark.slow
def test_a_million_communication_steps_need_no_more_memory() -> None:
    one = run_endurance(1_000_000)
    assert one.steps == INTERNAL * one.calls
    assert one.growth is None or one.growth < 1_000_000
