"""References on disk: the same values, another key for another question, damage healed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from curvebound.cosim import Scene, load_scene
from curvebound.study.identity import identity
from curvebound.study.reference import reference, reference_cache
from curvebound.study.reference.reference import refer
from curvebound.study.reference.reference_cache import question

pytest.importorskip("mpmath")
PATHS = ["plant.slider.u", "drive.parabola.ax"]


def short(stop: float = 0.3) -> Scene:
    scene = load_scene("active_damping")
    scene.stop_time = stop
    return scene


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    short().check()  # FMUs keep their own cache
    monkeypatch.setenv("CURVEBOUND_CACHE", str(tmp_path))
    return tmp_path / "references"


def test_what_is_kept_is_what_was_computed(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changes = {"plant.slider.u_start": np.array([0.4, 0.5, 0.6])}
    system = short(0.1).check()
    first = refer(system, PATHS, changes=changes)
    monkeypatch.setattr(reference, "collocate", None)  # it cannot be computed again
    again = refer(system, PATHS, changes=changes)
    times = np.linspace(0.0, 0.1, 77)
    for path in PATHS:
        assert np.array_equal(first.values(times)[path], again.values(times)[path])
        assert np.array_equal(first.uncertainty(path, times), again.uncertainty(path, times))
    assert again.how == first.how


def test_a_cache_that_can_only_be_read_serves(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    system = short(0.05).check()
    first = refer(system, PATHS)

    def refuse(path: Path) -> None:
        raise PermissionError

    monkeypatch.setattr("curvebound.cache.os.utime", refuse)
    monkeypatch.setattr(reference, "collocate", None)  # it cannot be computed again
    again = refer(system, PATHS)
    assert np.array_equal(first.values([0.05])[PATHS[0]], again.values([0.05])[PATHS[0]])


def test_a_file_that_was_cut_short_is_made_again(fresh: Path) -> None:
    system = short(0.05).check()
    first = refer(system, PATHS)
    (file,) = fresh.glob("*/*.npz")
    file.write_bytes(file.read_bytes()[:1000])
    again = refer(system, PATHS)
    assert np.array_equal(first.values([0.05])[PATHS[0]], again.values([0.05])[PATHS[0]])
    assert file.stat().st_size > 1000


@pytest.mark.parametrize(
    "change",
    [
        {"paths": ["plant.slider.u"]},
        {"stop": 0.2},
        {"continuous": True},
        {"changes": {"plant.slider.u_start": 0.6}},
        {"changes": {"plant.model.fidelity": "linear"}},
    ],
    ids=str,
)
def test_another_question_has_another_key(change: dict[str, Any]) -> None:
    system = short().check()
    asked = {"paths": PATHS, "stop": 0.3, "changes": {}, "continuous": False}
    assert question(system, **asked) != question(system, **{**asked, **change})


@pytest.mark.parametrize("path", ["plant.slider.u_start", "drive.feedback.slider_u"])
def test_another_scene_has_another_key_but_another_solver_has_not(path: str) -> None:
    keys = []
    for changes in ({}, {path: 0.123}, {"plant.solver.method": "implicit"}):
        scene = short()
        for name, value in changes.items():
            scene.set(name, value)
        keys.append(question(scene.check(), PATHS, 0.3, None, False))
    assert keys[0] == keys[2] != keys[1]


def pulse(begin: float) -> Any:
    def push(t: float) -> float:
        return 4.0 if begin <= t < begin + 1e-6 else 0.0

    return push


TABLES = [([0.0, 0.1, 0.1 + h, 0.3], [0.0, 0.0, 1.0, 0.0]) for h in (1e-9, 2e-9)]


def pushing(force: float) -> Any:
    """An object of a class that nothing can import."""

    class Push:
        def __init__(self) -> None:
            self.force = force

        def __call__(self, t: float) -> float:
            return self.force * t

    return Push()


@pytest.mark.parametrize(
    "signals",
    [[pulse(0.1), pulse(0.10001)], TABLES, [pushing(1.0), pushing(2.0)]],
    ids=["function", "table", "object"],
)
def test_signals_that_differ_between_all_samples_have_other_keys(signals: list[Any]) -> None:
    keys = []
    for signal in (*signals, signals[0]):
        scene = short()
        scene.input("plant.pendulum.fx", signal)
        system = scene.check()
        keys.append((question(system, PATHS, 0.3, None, True), identity(system)))
    for one, other, again in zip(*keys, strict=True):
        assert one == again != other


def test_the_code_of_a_reference_is_all_that_it_imports(tmp_path: Path) -> None:
    seen = set()

    def watch(*paths: Path) -> str:
        seen.update(path.name for path in paths)
        return ""

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reference_cache.cache, "sources", watch)
        reference_cache._code.__wrapped__()
    assert {"reference.py", "monolith.py", "collocation.py"} <= seen
    assert "tuner.py" not in seen


def test_a_changed_statement_is_another_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    system = short().check()
    before = question(system, PATHS, 0.3, None, True)
    texts = {"mechanics": "MECHANICS = another"}
    monkeypatch.setattr(reference_cache, "stated_in", lambda fmu: texts)
    assert question(system, PATHS, 0.3, None, True) != before
