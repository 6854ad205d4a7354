"""How figures are taken and read off: timing, interpolation, targets, report."""

from __future__ import annotations

import gc
import json
import math
from pathlib import Path

import pytest
from benchmarks.accuracy_section import cost_at
from benchmarks.peers import decades
from benchmarks.references import error_of
from benchmarks.report import as_data, print_report, save
from benchmarks.results import Section, Table, Target

from curvebound.study.timing import interleave, median, paused_gc, probe, ratio


def test_probes_take_turns_without_garbage_collection() -> None:
    order: list[str] = []
    collecting: list[bool] = []

    def measure(name: str, value: float) -> float:
        order.append(name)
        collecting.append(gc.isenabled())
        return value

    counted: list[int] = []
    samples = interleave(
        {"a": lambda: measure("a", 1.0), "b": lambda: measure("b", 2.0)},
        3,
        lambda: counted.append(1),
    )
    assert order == ["a", "b"] * 3
    assert collecting == [False] * 6
    assert gc.isenabled()
    assert samples == {"a": [1.0] * 3, "b": [2.0] * 3}
    assert len(counted) == 6


def test_garbage_collection_comes_back_after_an_error() -> None:
    with pytest.raises(RuntimeError), paused_gc():
        raise RuntimeError
    assert gc.isenabled()


def test_probe_resets_before_each_run_and_divides_by_the_work() -> None:
    calls: list[str] = []

    def work() -> None:
        calls.append("run")
        sum(range(1000))

    measure = probe(work, 4.0, reset=lambda: calls.append("reset"), sample=1e-3)
    calls.clear()
    assert measure() > 0.0
    assert calls[::2] == ["reset"] * (len(calls) // 2)
    assert calls[1::2] == ["run"] * (len(calls) // 2)


def test_ratio_is_taken_within_a_round() -> None:
    # the machine became three times slower in the last two rounds: nothing of that in the ratio
    ours, theirs = [2.0, 6.0, 6.2], [1.0, 3.0, 3.0]
    assert ratio(ours, theirs) == 2.0
    assert median(ours) == 6.0


def test_cost_is_interpolated_in_logarithms() -> None:
    points = [(1e-1, 1e-2, 1.0), (1e-2, 1e-4, 10.0), (1e-3, 1e-6, 100.0)]
    assert cost_at(points, 1e-4) == pytest.approx(10.0)
    assert cost_at(points, 1e-5) == pytest.approx(math.sqrt(1000.0))
    assert cost_at(points, 0.05) == 1.0
    assert cost_at(points, 1e-7) is None


def test_a_lucky_error_and_a_failed_run_do_not_count() -> None:
    lucky = [(1.0, 1e-9, 1.0), (0.5, 1e-4, 2.0), (0.25, 1e-8, 4.0)]
    assert cost_at(lucky, 1e-8) == pytest.approx(4.0)
    failed = [(1.0, 1e-4, 2.0), (0.5, 1e6, 3.0), (0.25, 1e-8, 4.0), (0.1, math.inf, 5.0)]
    assert cost_at(failed, 1e-8) == pytest.approx(4.0)


def test_decades() -> None:
    assert decades(-4, -6, 1) == pytest.approx((1e-4, 1e-5, 1e-6))
    assert len(decades(-4, -13)) == 19


def test_error_is_the_largest_component() -> None:
    exact = (0.275087462576117, -0.961419205099125, -4.17559810095173, -1.19474905456048)
    assert error_of("bead", exact) == 0.0
    assert error_of(
        "bead", (exact[0], exact[1] + 1e-3, exact[2] - 3e-3, exact[3])
    ) == pytest.approx(3e-3)


def test_targets_are_met_missed_or_unmeasured() -> None:
    assert Target("a", 1.3, 1.3).met is True
    assert Target("a", 1.3, 1.31).met is False
    assert Target("a", 100.0, 99.0, at_least=True).met is False
    assert Target("a", 100.0, 101.0, at_least=True).met is True
    assert Target("a", 1.0, None).met is None


def test_report_keeps_to_80_columns_and_json_is_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = ("tool and method", "1e-04", "1e-06", "1e-08", "1e-10", "1e-12", "best")
    row = ("FMU semi_implicit_euler", 1.2345e-5, 0.00123, 12.3456, 123456.0, None, 1e-15)
    section = Section(
        "accuracy",
        "Accuracy",
        [Table("pendulum", columns, [row]), Table("every point", ("value",), [(1.0,)])],
        [Target("x" * 120, 1.0, 0.5), Target("scipy", 100.0, 10.0, at_least=True)],
        ["heyoka is not installed: left out"],
    )
    described = {"processor": "a very long name " * 8}
    print_report([section], described, 7)
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= 80
    for text in ("FMU semi_implicit_euler", "1.2e-05", "12.3", "yes", "no", "heyoka is not"):
        assert text in printed
    assert "every point" not in printed
    print_report([section], described, 7, every_point=True)
    assert "every point" in capsys.readouterr().out

    path = tmp_path / "deep" / "bench.json"
    save(as_data([section], described, 7), path)
    data = json.loads(path.read_text("utf-8"))
    first = data["sections"]["accuracy"]["tables"][0]["rows"][0]
    assert first["tool and method"] == "FMU semi_implicit_euler"
    assert first["1e-12"] is None
    assert [target["met"] for target in data["targets"]] == [True, False]
    assert [p.name for p in path.parent.iterdir()] == ["bench.json"]
