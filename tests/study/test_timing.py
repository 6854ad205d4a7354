"""Timing in rounds, with a clock of the test's own."""

from __future__ import annotations

import gc
from types import SimpleNamespace

import pytest

from curvebound.study import timing


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Time that passes only where a test says so, in ns."""
    made = SimpleNamespace(now=0)
    made.process_time_ns = lambda: made.now
    monkeypatch.setattr(timing, "time", made)
    return made


@pytest.mark.parametrize(
    ("cost", "sample", "repeats"),
    [(1e-3, 5e-3, 5), (1e-3, 4.4e-3, 4), (1.0, 5e-3, 1), (0.0, 5e-6, 50)],
)
def test_a_probe_repeats_until_a_sample_is_long_enough(
    clock: SimpleNamespace, cost: float, sample: float, repeats: int
) -> None:
    """Per unit of work, after two runs that count for nothing; what precedes a run is not timed."""
    calls: list[str] = []

    def run() -> None:
        calls.append("run")
        clock.now += round(cost * 1e9)

    def reset() -> None:
        calls.append("reset")
        clock.now += 10**9

    measure = timing.probe(run, 4.0, reset=reset, sample=sample)
    assert calls == ["reset", "run"] * 2
    calls.clear()
    assert measure() == pytest.approx(cost / 4.0)
    assert calls == ["reset", "run"] * repeats
    assert timing.probe(run, 2.0)() == pytest.approx(cost / 2.0)


def test_what_is_compared_is_measured_in_turn() -> None:
    said: list[str] = []

    def of(name: str, *values: float):
        given = iter(values)

        def measure() -> float:
            said.append(name)
            assert not gc.isenabled()
            return next(given)

        return measure

    found = timing.interleave(
        {"a": of("a", 1.0, 2.0, 30.0), "b": of("b", 4.0, 1.0, 10.0)}, 3, lambda: said.append("|")
    )
    assert "".join(said) == "a|b|" * 3
    assert found == {"a": [1.0, 2.0, 30.0], "b": [4.0, 1.0, 10.0]}
    assert gc.isenabled()
    assert timing.median(found["a"]) == 2.0
    assert timing.ratio(found["a"], found["b"]) == 2.0
    gc.disable()
    try:
        with timing.paused_gc():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
