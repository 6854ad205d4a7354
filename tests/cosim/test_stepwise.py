"""A scene stepped by its caller: the bits of a run, states to return to, failures that are said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curvebound.cosim import Adaptive, Scene, load_scene, scene_names
from curvebound.cosim.stepwise import Stepwise
from curvebound.errors import CurveboundError


def rows_of(stepped: Stepwise, count: int) -> np.ndarray:
    rows = [stepped.row().copy()]
    for _ in range(count):
        stepped.step()
        rows.append(stepped.row().copy())
    return np.array(rows)


def run_of(scene: Scene) -> np.ndarray:
    data = scene.run().data
    return np.array([[float(value) for value in row] for row in data.tolist()])


@pytest.mark.parametrize("name", scene_names())
def test_it_takes_the_bits_of_a_run(name: str) -> None:
    scene = load_scene(name)
    scene.record_every = 1
    scene.stop_time = scene.start_time + 200 * scene.step
    expected = run_of(scene)
    with Stepwise(scene) as stepped:
        stepped.begin()
        assert np.array_equal(rows_of(stepped, len(expected) - 1), expected)


@pytest.mark.parametrize("algorithm", ["gauss_seidel", "jacobi", "strang", "midpoint"])
def test_a_saved_state_leads_to_the_same_bits(algorithm: str) -> None:
    scene = load_scene("swaying_parabola")
    scene.algorithm = algorithm
    scene.goes_back = True
    with Stepwise(scene) as stepped:
        stepped.begin()
        rows_of(stepped, 37)
        first = stepped.save()
        once = rows_of(stepped, 50)
        second = stepped.save()
        stepped.restore(first)
        assert stepped.time == first.time
        assert np.array_equal(rows_of(stepped, 50), once)
        stepped.restore(second)
        assert np.array_equal(stepped.row(), once[-1])
        stepped.drop(first)
        assert stepped.has(second)
        assert not stepped.has(first)


def test_steps_are_cut_where_inputs_jump_also_after_going_back() -> None:
    scene = load_scene("pendulum_large")
    scene.input("plant.pendulum.fx", ([0.0, 0.023, 0.023, 0.051, 0.051], [0.0, 0.0, 4.0, 4.0, 0.0]))
    scene.stop_time = 0.1
    scene.goes_back = True
    expected = run_of(scene)
    assert len(expected) == 13
    with Stepwise(scene) as stepped:
        stepped.begin()
        moments = []
        for row in expected[1:]:
            moments.append(stepped.save())
            stepped.step()
            assert np.array_equal(stepped.row(), row)
        for k, moment in enumerate(moments):
            stepped.restore(moment)
            stepped.step()
            assert np.array_equal(stepped.row(), expected[k + 1])


def test_a_failure_is_said_and_begin_helps() -> None:
    scene = load_scene("swaying_parabola")
    scene.input("drive.waveform.duration", lambda t: -1.0 if t > 0.05 else 1.0)
    with Stepwise(scene) as stepped:
        stepped.begin()
        moment = stepped.save()
        with pytest.raises(CurveboundError, match=r"swaying_parabola failed .*waveform\.duration"):
            rows_of(stepped, 20)
        assert not stepped.alive
        assert not stepped.has(moment)
        with pytest.raises(CurveboundError, match="begin anew"):
            stepped.step()
        stepped.begin()
        rows_of(stepped, 3)


def test_a_scene_that_chooses_its_steps_is_refused() -> None:
    scene = load_scene("pendulum_small")
    scene.adaptive = Adaptive()
    with pytest.raises(CurveboundError, match="set adaptive to None"):
        Stepwise(scene)


def test_a_scene_as_text_is_the_same_scene(tmp_path: Path) -> None:
    from curvebound.cosim.scene_text import scene_text

    scene = load_scene("inverted_balance")
    scene.stop_time = 6.0
    scene.variant("gentle", {"drive.feedback.slider_u": -40.0})
    (tmp_path / "again.py").write_text(scene_text(scene), encoding="utf-8")
    again = load_scene(tmp_path / "again.py")
    assert np.array_equal(run_of(again), run_of(scene))
    assert again.variants == scene.variants
    assert again.needs == scene.needs
    scene.input("plant.slider.fx", lambda t: t)
    with pytest.raises(CurveboundError, match=r"plant\.slider\.fx is a function"):
        scene_text(scene)
