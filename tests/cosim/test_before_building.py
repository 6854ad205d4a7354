"""A scene of systems of one's own: what is wrong in it is told before anything is compiled."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from curvebound.cosim import Scene, capabilities
from curvebound.errors import CurveboundError
from curvebound.fmi import cached

OWN = Path(__file__).parents[1] / "mechanics" / "systems" / "bead_on_parabola"


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Scene:
    """A scene of a new system, which is not to be built."""

    def never(folder: object) -> Path:
        raise AssertionError(f"{folder} is built")

    monkeypatch.setattr(cached, "cached_fmu", never)
    shutil.copytree(OWN, tmp_path / "bead_on_parabola", dirs_exist_ok=True)
    made = Scene("new", stop_time=0.1, step=0.01)
    made.folder = tmp_path
    return made


def problems(scene: Scene) -> str:
    with pytest.raises(CurveboundError) as caught:
        scene.check()
    return str(caught.value)


def test_names_and_values_are_checked_by_descriptions(scene: Scene) -> None:
    scene.add("own", "./bead_on_parabola", {"bead.mas": 1.0})
    assert "own.bead.mas: BeadOnParabola has no such variable; did you mean" in problems(scene)


@pytest.mark.parametrize("value", ["nan", float("nan")])
def test_nan_is_no_start_value(scene: Scene, value: float | str) -> None:
    scene.add("own", "./bead_on_parabola", {"bead.mass": value})
    assert "own.bead.mass: nan is no value; give a number" in problems(scene)


def test_recorded_outputs_are_checked(scene: Scene) -> None:
    scene.add("own", "./bead_on_parabola")
    scene.record("own.bead.z")
    assert "own.bead.z names no variable of own that is an output to record" in problems(scene)


def test_a_system_with_a_mistake_is_named_before_another_is_built(
    scene: Scene, tmp_path: Path
) -> None:
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "fmu.py").write_text("FMU = 1\n")
    scene.add("own", "./bead_on_parabola")
    scene.add("other", "./broken")
    assert "component other: " in problems(scene)


def test_what_is_right_is_built(scene: Scene) -> None:
    scene.add("own", "./bead_on_parabola")
    assert capabilities.has_unbuilt(scene)
    with pytest.raises(AssertionError, match="is built"):
        scene.check()
