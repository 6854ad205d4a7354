"""A study's rows: what each says, when a family is left, and what a journal brings back."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from curvebound.study.grid import Family
from curvebound.study.precision import study as module
from curvebound.study.precision.study import Study
from curvebound.study.reference.reference_set import Verdict
from curvebound.study.runner import Outcome
from curvebound.study.settings import Setting

FULL, SIMPLE = (("b.model", "full"),), (("b.model", "simple"),)
PATHS = ["b.x", "b.y"]


def verdicts(x: float, y: float, *, judged: bool = True, until: float = 2.0) -> dict[str, Verdict]:
    return {
        "b.x": Verdict(0.5 * x, x, 2.0, True, x), "b.y": Verdict(0.5 * y, y, until, judged, y)
    }  # fmt: skip


class Truth:
    """References: errors against the best model, against the setting's own, and between both."""

    system = SimpleNamespace(scene=SimpleNamespace(stop_time=2.0))
    paths = PATHS

    def errors(self, times: Any, outputs: Any, model: Any = None) -> dict[str, Verdict]:
        if model is None:
            return verdicts(3.0, 1.0, judged=False, until=1.5)
        assert model == {"b.model": "simple"}
        return verdicts(0.1, 0.25)

    def modelling(self, model: Any, times: Any) -> dict[str, Verdict]:
        return verdicts(2.0, 0.75)

    def values(self, model: Any, times: Any) -> dict[str, Any]:
        assert model == {"b.model": "full"}
        return {"b.x": np.array([[1.0, 9.0], [-1.0, 0.0]]), "b.y": np.array([[0.0], [5.0]])}

    def of_model(self, model: Any) -> Any:
        return SimpleNamespace(
            how="solved twice", uncertainty=lambda path, times: np.array([[1e-9 * times[0]]])
        )


class Space:
    structures = (FULL, SIMPLE)
    approximate = (False, True)
    best_model = MappingProxyType({"b.model": "full"})

    def is_approximate(self, setting: Setting) -> bool:
        return setting.structure == SIMPLE

    def model(self, setting: Setting) -> dict[str, str]:
        return dict(setting.structure)


class Runs:
    """A runner whose runs all give the same, but for settings that fail."""

    def __init__(self, *_: Any, failing: tuple[float, ...] = ()) -> None:
        self.failing = failing
        self.ran: list[Setting] = []

    def __enter__(self) -> Runs:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def run(self, setting: Setting) -> Outcome:
        self.ran.append(setting)
        times = np.array([0.0, 1.0])
        return Outcome(
            times, {}, {"energy.residual": 1e-3, "energy.kinetic": 2.0},
            {"solver.steps": 10, "solver.evaluations": 40},
            "it left" if setting.size in self.failing else "", 0.5,
        )  # fmt: skip

    def cost(self, setting: Setting, *, runs: int, enough: float) -> float:
        assert (runs, enough) == (1, 3e-3)
        return 0.25


def setting(size: float | None = 0.1, *, method: str = "rk4", step: float = 1.0,
            structure: Any = FULL) -> Setting:  # fmt: skip
    return Setting(structure, method, size, step, "gauss_seidel")


def study(limit: float = 2.0) -> Study:
    scene: Any = SimpleNamespace(start_time=0.0, stop_time=2.0)
    return Study(scene, SimpleNamespace(), Space(), PATHS, True, limit)  # type: ignore[arg-type]


def row(one: Setting, runner: Any, purpose: str = "micro", continuous: Any = None) -> Any:
    return study()._row(Family(purpose, (one,)), one, runner, Truth(), continuous)  # type: ignore[arg-type]


def test_a_row_tells_setting_cost_and_errors() -> None:
    found = row(setting(), Runs())
    assert found == {
        "purpose": "micro", "form": setting().form, "method": "rk4", "size_is": "step",
        "size": 0.1, "macro_step": 1.0, "algorithm": "gauss_seidel", "hold": "zero",
        "coupling": "gauss_seidel", "cpu": 0.25, "steps": 10, "evaluations": 40,
        "energy_residual": 1e-3, "drift": None, "acceleration_error": None, "kinetic": 2.0,
        "failure": "", "modelling": 0.0, "error": 3.0, "numerical": 3.0, "judged": False,
        "judged_until": 1.5, "amplitude": 5.0, "amplitude.b.x": 2.0, "amplitude.b.y": 5.0,
        "total.worst.b.x": 3.0, "total.worst.b.y": 1.0, "total.final.b.x": 1.5,
        "total.final.b.y": 0.5, "numerical.worst.b.x": 3.0, "numerical.worst.b.y": 1.0,
        "numerical.final.b.x": 1.5, "numerical.final.b.y": 0.5,
    }  # fmt: skip
    assert row(setting(1e-6, method="adaptive"), Runs())["size_is"] == "tolerance"
    assert row(setting(None, method="exact"), Runs())["size_is"] is None


def test_a_simpler_model_has_errors_of_its_own() -> None:
    found = row(setting(structure=SIMPLE), Runs())
    names = ("error", "numerical", "modelling", "judged", "judged_until")
    assert [found[name] for name in names] == [3.0, 0.25, 2.0, True, 2.0]
    assert (found["modelling.worst.b.x"], found["modelling.final.b.y"]) == (2.0, 0.375)
    assert (found["numerical.worst.b.x"], found["total.worst.b.x"]) == (0.1, 3.0)


def test_a_run_that_fails_has_no_errors() -> None:
    found = row(setting(), Runs(failing=(0.1,)))
    assert (found["error"], found["numerical"], found["judged"]) == (math.inf, math.inf, False)
    assert (found["judged_until"], found["failure"], found["cpu"]) == (None, "it left", 0.5)
    runner = Runs()
    runner.run = lambda _: Outcome(np.array([0.0]), {})  # type: ignore[method-assign]
    assert row(setting(), runner)["failure"] == "nothing was recorded"


def test_macro_steps_are_set_against_what_acts_all_the_time_too() -> None:
    assert row(setting(), Runs(), "macro", Truth())["from_continuous"] == 3.0
    assert "from_continuous" not in row(setting(), Runs(), "micro", Truth())


@pytest.mark.parametrize(
    ("purpose", "size", "step", "numerical", "cpu", "hopeless"),
    [
        ("micro", 0.1, 1.0, 1e-15, 1e-3, True),  # rounding: nothing new
        ("micro", 0.1, 1.0, 3.1e-15, 1e-3, False),
        ("micro", 0.1, 1.0, math.inf, 1e-3, False),
        ("macro", 0.1, 1.0, 1e-15, 1e-3, False),
        # ten times as many steps in 2 s, and the limit is 2 s of CPU
        ("micro", 0.1, 1.0, 1.0, 0.099, False),
        ("micro", 0.1, 1.0, 1.0, 0.101, True),
        ("macro", 1.0, 0.05, 1.0, 0.049, False),
        ("macro", 1.0, 0.05, 1.0, 0.051, True),
    ],
)
def test_what_would_cost_too_much_or_show_nothing_is_left(
    purpose: str, size: float, step: float, numerical: float, cpu: float, hopeless: bool
) -> None:
    before = {"numerical": numerical, "size": 1.0, "macro_step": 1.0, "cpu": cpu}
    one = setting(size, step=step)
    assert study()._hopeless(Family(purpose, (one,)), one, before) is hopeless
    # tolerances tell nothing of cost
    other = setting(1e-9, method="adaptive")
    assert not study()._hopeless(Family("macro", (other,)), other, before | {"cpu": 0.9})


@pytest.fixture
def surrounded(monkeypatch: pytest.MonkeyPatch) -> list[Runs]:
    """All that a study asks is the test's; gives the runners that it makes."""
    families = [
        Family("micro", (setting(0.4), setting(0.2), setting(0.1))),
        Family("micro", (setting(0.4, structure=SIMPLE),)),
    ]
    made: list[Runs] = []

    def runner(*_: Any) -> Runs:
        made.append(Runs(failing=(0.2,)))
        return made[-1]

    for name, value in (
        ("grid", lambda *_, quick: families), ("is_sampled", lambda *_: False),
        ("ReferenceSet", lambda *_, **__: Truth()), ("Runner", runner),
        ("identity", lambda *_, **__: "this one"), ("time_again", lambda *_: []),
        ("amplitude_rows", lambda *_: [{"key": "amplitude|1", "purpose": "amplitude"}]),
    ):  # fmt: skip
        monkeypatch.setattr(module, name, value)
    return made


def test_a_study_runs_what_is_not_in_its_journal(surrounded: list[Runs], tmp_path: Path) -> None:
    journal = tmp_path / "journal"
    told: list[tuple[int, int, str]] = []
    first = study()
    first.run(journal, lambda *given: told.append(given))
    assert first.complete
    assert [one["key"].partition("|")[0] for one in first.rows] == ["micro"] * 4 + ["amplitude"]
    assert [(done, count) for done, count, _ in told] == [
        (0, 4), (0, 4), (1, 4), (2, 4), (3, 4), (4, 4), (4, 4), (4, 4)
    ]  # fmt: skip
    assert [text for *_, text in told[-3:]] == ["the cheapest again", "smaller motions", "done"]
    assert first.references == [
        {"what": what, "model": {"b.model": model}, "how": "solved twice",
         "uncertainty": {"b.x": 2e-9, "b.y": 2e-9}}
        for what, model in (("scene", "full"), ("simpler model", "simple"))
    ]  # fmt: skip
    lines = journal.read_text().splitlines()
    assert json.loads(lines[0]) == {"identity": "this one"}
    assert len(lines) == 1 + 5
    # half of it is lost, with a line cut in the middle
    cut = tmp_path / "cut"
    cut.write_text("\n".join([*lines[:3], lines[3][:20]]) + "\n")
    second = study()
    second.run(cut)
    assert [len(runner.ran) for runner in surrounded] == [4, 2]
    assert [one["key"] for one in second.rows] == [one["key"] for one in first.rows]
    # another study's begins anew
    other = tmp_path / "other"
    other.write_text("\n".join(['{"identity": "other"}', *lines[1:]]) + "\n")
    study().run(other)
    assert len(surrounded[-1].ran) == 4
    assert json.loads(other.read_text().splitlines()[0]) == {"identity": "this one"}


def test_a_family_is_left_where_it_becomes_too_dear(surrounded: list[Runs]) -> None:
    """0.25 s of CPU per second, twice as much with half the step, for 2 s."""
    one = study(limit=0.99)
    one.run()
    assert [run.size for run in surrounded[-1].ran] == [0.4, 0.4]
    assert one.complete
