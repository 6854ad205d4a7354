"""Settings, tuning and writing a choice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import curvebound
from curvebound.cosim import load_scene
from curvebound.errors import CurveboundError
from curvebound.study.grid import Family, grid
from curvebound.study.identity import identity
from curvebound.study.precision.lessons import order_of
from curvebound.study.precision.study import Study
from curvebound.study.settings import space_of
from curvebound.study.starts import initial_values, surrounding, unseen
from curvebound.study.tune.script import choice_block, put_choice, script_of
from curvebound.study.tune.tuner import Tuner

pytest.importorskip("mpmath")


def test_exact_is_offered_with_the_linear_model_only() -> None:
    space = space_of(load_scene("pendulum_small").check())
    exact = [f for f in space.families(0.01, "gauss_seidel") if f.method == "exact"]
    assert [f.form for f in exact] == ["linear"]
    kept = space_of(load_scene("bead_on_wire").check(), {"bead.model.formulation": "angle"})
    assert [dict(s)["bead.model.formulation"] for s in kept.structures] == ["angle"]


def test_starts_stay_within_their_range() -> None:
    system = load_scene("pendulum_large").check()
    own = initial_values(system)
    for found in (surrounding(system, 0.2, 12), unseen(system, 0.2, 30)):
        for path, values in found.items():
            assert max(abs(values / own[path] - 1.0)) <= 0.2 + 1e-12


def test_starts_of_feedback_vary_about_its_set_point_and_keep_the_shape() -> None:
    """A fifth of an angle of pi would be a fall, and another parabola one that is not held."""
    system = load_scene("inverted_balance").check()
    found = unseen(system, 0.2, 30)
    assert list(found) == ["plant.pendulum.angle_start"]
    distance = np.pi - found["plant.pendulum.angle_start"]
    assert 0.08 < distance.min() < distance.max() < 0.12
    driven = unseen(load_scene("pumped_swing").check(), 0.2, 30)  # a law without feedback
    assert "plant.parabola.coefficient_start" in driven


@pytest.fixture(scope="module")
def short() -> Tuner:
    scene = load_scene("bead_on_wire")
    scene.stop_time = 2.0
    tuner = Tuner(scene, list(scene.needs.errors), starts=4)
    yield tuner
    tuner.close()


@pytest.mark.usefixtures("timed_once")
@pytest.mark.parametrize("bound", [pytest.param(1e-4, marks=pytest.mark.slow), 1e-9])
def test_the_choice_meets_its_bound_from_fresh_starts(short: Tuner, bound: float) -> None:
    limits = dict.fromkeys(short.paths, bound)
    choice = short.tune(limits)
    assert choice.chosen is not None
    assert choice.runs < 400
    from curvebound.study.reference.reference_set import ReferenceSet

    fresh = unseen(short.system, 0.2, 5)
    checks = ReferenceSet(short.system, short.space.best_model, short.paths, changes=fresh)
    for member in range(5):
        start = {path: float(values[member]) for path, values in fresh.items()}
        outcome = short.runner.glance(choice.chosen.setting, start)
        verdicts = checks.errors(outcome.times, outcome.outputs, member=member, least=limits)
        assert max(v.worst for v in verdicts.values()) <= bound


@pytest.mark.usefixtures("timed_once")
def test_a_smooth_drive_is_tuned_to_slopes(tmp_path: Path) -> None:
    """Chosen, written into the script, and the bound met by it against continuous action."""
    script = tmp_path / "pushed.py"
    script.write_text(
        "import math\nfrom curvebound.cosim import Scene\n"
        'scene = Scene("pushed", stop_time=0.5, step=0.02)\n'
        'scene.add("bead", "BeadOnWire", {"bead.angle_start": 0.3})\n'
        'scene.input("bead.wire.ax", lambda t: 3.0 * math.sin(4.0 * t))\n'
        'scene.record("bead.bead.angle")\n',
        encoding="utf-8",
    )
    scene = load_scene(script)
    path, bound = "bead.bead.angle", 1e-5
    tuner = Tuner(scene, [path], continuous=True, starts=3)
    try:
        choice = tuner.tune({path: bound})
        assert choice.chosen is not None
        setting = choice.chosen.setting
        assert setting.hold == "first"
        put_choice(script, choice_block(scene, tuner.space, setting, []))
        assert 'scene.set("hold", "first")' in script.read_text(encoding="utf-8")
        chosen = load_scene(script)
        result = chosen.run()
        true = tuner.references.values(tuner.space.best_model, result.time)[path][:, 0]
        assert np.max(np.abs(result[path] - true)) <= bound
        chosen.hold = "zero"
        assert np.max(np.abs(chosen.run()[path] - true)) > 10.0 * bound
    finally:
        tuner.close()


def test_what_a_hold_changes_is_another_result() -> None:
    scene = load_scene("shaken_wire")
    before = identity(scene.check())
    scene.hold = "first"
    assert identity(scene.check()) != before


def test_other_sources_of_the_package_give_other_results(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    system = load_scene("shaken_wire").check()
    before = identity(system)
    package = Path(curvebound.__file__).parent
    monkeypatch.setattr(
        "curvebound.study.identity.cache.sources", lambda path: str(path == package)
    )
    changed = identity(system)
    assert changed != before
    monkeypatch.setattr("curvebound.study.identity.cache.sources", lambda path: "True")
    assert identity(system) == changed


def test_where_nothing_fits_it_says_by_how_much(
    short: Tuner, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(short, "limit", 0.05)
    choice = short.tune(dict.fromkeys(short.paths, 1e-17))
    assert choice.chosen is None
    assert choice.best.miss > 1.0
    assert choice.advice


@pytest.mark.slow  # of costs by known laws in test_choosing.py
def test_a_budget_that_cannot_be_kept_is_said(short: Tuner) -> None:
    choice = short.tune(dict.fromkeys(short.paths, 1e-6), budget=1e-9)
    assert choice.chosen is not None
    assert not choice.within_budget


@pytest.mark.slow
@pytest.mark.parametrize("slopes", [False, True])
def test_continuous_control_asks_for_a_shorter_macro_step_or_for_slopes(
    monkeypatch: pytest.MonkeyPatch, slopes: bool
) -> None:
    """Held over 10 ms, the law is off by 4e-3 of what it would do all the time."""
    if not slopes:
        monkeypatch.setattr("curvebound.study.grid.has_slopes", lambda _: False)
    scene = load_scene("active_damping")
    scene.stop_time = 1.0
    tuner = Tuner(scene, list(scene.needs.errors), continuous=True, starts=4)
    try:
        loose, tight = (tuner.tune(dict.fromkeys(tuner.paths, bound)) for bound in (1e-2, 1e-3))
    finally:
        tuner.close()
    assert loose.chosen is not None
    assert loose.chosen.setting.step == scene.step
    assert tight.chosen is not None
    setting = tight.chosen.setting
    assert setting.hold == ("first" if slopes else "zero")
    assert setting.step == scene.step if slopes else setting.step < 0.3 * scene.step
    assert max(v.worst for v in tight.chosen.verdicts.values()) <= 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "bounds", "continuous"),
    [
        ("bead_on_wire", [1e-2, 1e-6], False),
        ("shaken_wire", [1e-4, 1e-5], True),
        ("swaying_parabola", [1e-3, 1e-4], True),
    ],
)
def test_tuning_keeps_its_promises_on_a_short_scene(
    monkeypatch: pytest.MonkeyPatch, name: str, bounds: list[float], continuous: bool
) -> None:
    """The check itself: fresh starts, and the cost against the grid's best."""
    from benchmarks import promises as verify

    scene = load_scene(name)
    scene.stop_time = 1.0
    monkeypatch.setattr(verify, "load_scene", lambda name: scene)
    cases = verify.verify_scene(
        name, bounds, fresh=3, quick=True, limit=0.05, continuous=continuous
    )
    assert [case.bound for case in cases] == bounds
    for case in cases:
        assert case.met == case.judged == case.fresh == 3
        assert case.worst <= 1.0
        assert case.ratio is not None
        assert case.remark == ""
        assert case.until == 1.0


def test_a_promise_that_is_not_kept_is_named() -> None:
    from benchmarks.promises import Case, broken

    def case(met: int, ratio: float | None, setting: str = "angle, rk4", best: str = "b") -> Case:
        return Case("s", 1e-4, setting, met, 20, 20, 0.5, 1e-5, best, 1e-5, ratio, 1.0, 1.0, 9)

    assert broken([case(20, 1.4), case(19, None, best="none")]) == []
    (few,) = broken([case(19, 1.0), case(18, 1.0)])
    assert few == "s: bounds met at fewer than 95% of the starts"
    (dear,) = broken([case(20, 1.6)])
    assert dear == "s, 1e-04: 1.60 times the cost of b"
    (nothing,) = broken([case(20, None, setting="none")])
    assert nothing == "s, 1e-04: found nothing, and the grid has b"


def test_a_choice_is_written_once_and_replaced(short: Tuner, tmp_path: Path) -> None:
    from curvebound.places import scenarios_directory

    script = tmp_path / "mine.py"
    script.write_text((scenarios_directory() / "bead_on_wire.py").read_text())
    for method, size in (("rk4", 1e-3), ("adaptive", 1e-7)):
        setting = short.space.families(0.02, "gauss_seidel")[0].__class__(
            short.space.structures[0], method, size, 0.02, "gauss_seidel"
        )
        put_choice(script, choice_block(short.scene, short.space, setting, ["a remark"]))
    text = script.read_text()
    assert text.count("chosen by") == 1
    assert text.index("chosen by") < text.index("__main__")
    start = load_scene(script).components["bead"].start
    assert start["solver.method"] == "adaptive"
    assert start["model.formulation"] == "angle"
    assert load_scene(script).step == 0.02
    with pytest.raises(CurveboundError, match=r"\.ssp"):
        script_of("a.ssp")


@pytest.mark.parametrize(
    "methods",
    [("rk4", "adaptive"), pytest.param((), marks=pytest.mark.slow)],
    ids=["a few", "all"],
)
@pytest.mark.usefixtures("timed_once")
def test_a_study_resumes_and_finds_the_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, methods: tuple[str, ...]
) -> None:
    """Of a few methods of one formulation, or of all that the grid has."""

    def few(*arguments: Any, **options: Any) -> list[Family]:
        return [
            family
            for family in grid(*arguments, **options)
            for one in family.settings[:1]
            if not methods or (one.method in methods and "angle" in dict(one.structure).values())
        ]

    monkeypatch.setattr("curvebound.study.precision.study.grid", few)
    monkeypatch.setattr("curvebound.study.precision.repeated_timing._ROUNDS", 1)
    scene = load_scene("bead_on_wire")
    scene.stop_time = 0.5
    journal = tmp_path / "study.jsonl"

    class Enough(KeyboardInterrupt):
        pass

    def stop_at(done: int, count: int, label: str) -> None:
        if done >= 12:
            raise Enough

    first = Study.of(scene, quick=True, limit=0.01)
    with pytest.raises(Enough):
        first.run(journal, stop_at)
    kept = len(journal.read_text().splitlines()) - 1
    assert 0 < kept == len(first.rows)
    second = Study.of(scene, quick=True, limit=0.01)
    second.run(journal)
    assert second.complete
    assert [r["key"] for r in second.rows[:kept]] == [r["key"] for r in first.rows]
    assert second.rows[0]["cpu"] == first.rows[0]["cpu"]  # not measured again
    assert order_of(second.rows, "angle", "rk4") == pytest.approx(4.0, abs=0.2)
    sizes = sum(len(f.settings) for f in few(scene, second.space, quick=True))
    assert len(second.rows) <= sizes


@pytest.mark.usefixtures("timed_once")
def test_rows_at_smaller_starts_are_kept_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("curvebound.study.precision.study.grid", lambda *_, **__: [])
    scene = load_scene("pendulum_small")
    scene.stop_time = 0.2
    journal = tmp_path / "study.jsonl"
    first, second = (Study.of(scene, quick=True) for _ in range(2))
    first.run(journal)
    assert first.rows
    assert {row["purpose"] for row in first.rows} == {"amplitude"}
    monkeypatch.setattr("curvebound.study.runner.Runner.run", None)  # nothing is measured again
    second.run(journal)
    assert second.rows == first.rows
    assert len(journal.read_text().splitlines()) == 1 + len(first.rows)


def test_a_choice_keeps_a_scripts_encoding_and_line_ends(tmp_path: Path) -> None:
    script = tmp_path / "mine.py"
    script.write_bytes(b"# -*- coding: latin-1 -*-\r\nname = 'caf\xe9'\r\n")
    put_choice(script, "# chosen by `curvebound tune`\nx = 1\n# end of the choice\n")
    data = script.read_bytes()
    assert b"caf\xe9" in data
    assert data.count(b"\n") == data.count(b"\r\n") == 6
    script.write_bytes(b"name = 'caf\xe9'\n")
    with pytest.raises(CurveboundError, match="cannot be read"):
        put_choice(script, "x = 1\n")
    assert script.read_bytes() == b"name = 'caf\xe9'\n"


def test_what_is_kept_has_to_exist_and_is_what_is_judged_by() -> None:
    system = load_scene("pendulum_small").check()
    for keep in ({"plant.model.fidelty": "linear"}, {"plant.model.fidelity": "cubic"}):
        with pytest.raises(CurveboundError, match=r"no choice plant\.model\.fidel.* to keep"):
            space_of(system, keep)
    assert not space_of(system).is_simpler
    kept = space_of(system, {"plant.model.fidelity": "linear"})
    assert kept.is_simpler
    assert kept.best_model == {"plant.model.fidelity": "linear"}


def test_a_frame_rate_that_makes_too_many_steps_is_refused() -> None:
    scene = load_scene("bead_on_wire")
    with pytest.raises(CurveboundError, match="give one of at most"):
        Tuner(scene, list(scene.needs.errors), frame_rate=1e9)
