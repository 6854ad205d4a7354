"""What README and scenes say of themselves, sentence by sentence, where no other test does."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from curvebound import linearize
from curvebound.cosim import Scene, load_scene
from curvebound.places import fmus_directory

README = Path(__file__).parents[2] / "README.md"
EVIDENCE = README.parent / "tests" / "benchmarks" / "README.md"


@pytest.fixture(scope="module")
def example() -> Scene:
    """The coupled scene of the README, as it stands there."""
    blocks = re.findall(r"(?ms)^```python\n(.*?)^```$", README.read_text(encoding="utf-8"))
    (block,) = [text for text in blocks if "connect_matching" in text]
    names: dict[str, object] = {}
    exec(block.partition("result =")[0], names)
    scene = names["scene"]
    assert isinstance(scene, Scene)
    return scene


def test_the_feedback_of_the_readme_is_a_stable_loop(example):
    start = example.components["drive"].start
    rest = {"slider.u": 0.0, "pendulum.angle": 0.0}
    plant = linearize("ParabolaPendulum", at=rest, inputs=["parabola.ax"])
    system, column = plant.A, plant.B
    gains = [f"feedback.{name.replace('.', '_')}" for name in plant.states]
    row = np.array([[start.get(name, 0.0) for name in gains]])
    closed = np.linalg.eigvals(system - column @ row)
    assert np.max(closed.real) < -0.3
    # sampled at each communication point and held, as the scene does it
    step, n = example.step, len(system)
    both = np.zeros((n + 1, n + 1))
    both[:n, :n], both[:n, n:] = system, column
    term, held = np.eye(n + 1), np.eye(n + 1)
    for k in range(1, 20):
        term = term @ both * (step / k)
        held += term
    assert np.max(np.abs(np.linalg.eigvals(held[:n, :n] - held[:n, n:] @ row))) < 1.0


def test_the_feedback_of_the_readme_damps_the_pendulum(example):
    result = example.run()
    late = result.time > result.time[-1] - 3.0
    assert abs(result["plant.pendulum.angle"][0]) == 1.0
    for name in ("pendulum.angle", "slider.u", "parabola.x"):
        assert np.max(np.abs(result[f"plant.{name}"][late])) < 0.05, name
    longer = example.copy()
    longer.stop_time = 60.0
    assert np.max(np.abs(longer.run()["plant.parabola.x"])) < 5.0


def test_a_shaken_bead_is_swung_up_until_its_frequency_has_moved_away():
    scene = load_scene("shaken_wire")
    result = scene.run()
    size = np.abs(result["bead.bead.angle"])
    assert np.max(size[result.time < 2.0]) < 0.2
    assert np.max(size) > 0.7
    assert np.max(size) < math.pi  # no further: large swings are slower
    assert np.max(np.abs(result["bead.wire.y"])) < 0.11  # 5 cm to either side, and no drift


def test_a_swaying_parabola_sways_about_a_point_and_moves_the_pendulum():
    result = load_scene("swaying_parabola").run()
    x = result["plant.parabola.x"]
    middle = 0.5 * (np.max(x) + np.min(x))
    amplitude = 0.5 / (2.0 * math.pi * 0.35) ** 2
    assert np.ptp(x) == pytest.approx(2.0 * amplitude, rel=0.01)
    assert abs(middle) == pytest.approx(amplitude, rel=0.01)  # it starts at a turning point
    assert np.max(np.abs(result["plant.slider.u"])) > 3.0 * np.ptp(x)


def test_projection_keeps_the_bead_on_its_wire_and_nothing_does_not():
    scene = load_scene("bead_on_wire")
    kept = scene.run()
    assert np.max(np.abs(kept["bead.constraint.drift"])) < 1e-15
    assert np.max(np.abs(kept["bead.energy.residual"])) < 1e-9
    scene.set("bead.constraint.stabilization", "none").set("bead.solver.step", 1.0 / 60.0)
    assert np.max(np.abs(scene.run()["bead.constraint.drift"])) > 1e-6


def test_started_high_neighbours_part_and_the_linear_model_is_of_no_use():
    scene = load_scene("pendulum_large")
    scene.stop_time, scene.tolerance = 20.0, 1e-12
    first = scene.run()
    angle = first["plant.pendulum.angle"]
    moved = scene.copy().set("plant.pendulum.angle_start", 2.8 + 1e-8).run()
    grown = np.abs(moved["plant.pendulum.angle"] - angle) / 1e-8
    assert 20.0 < np.max(grown[first.time <= 10.0]) < 40.0
    assert np.max(grown) > 1e6
    linear = scene.copy().set("plant.model.fidelity", "linear")
    assert np.max(np.abs(linear.run()["plant.pendulum.angle"] - angle)) > 1.0


def test_the_linear_scene_is_a_sum_of_two_modes_and_says_how_far_it_is_off():
    result = load_scene("pendulum_small").run()
    t, u, angle = (result[name] for name in ("time", "plant.slider.u", "plant.pendulum.angle"))
    modes = [f(w * t) for w in (2.39719939786409, 5.78735129803610) for f in (np.cos, np.sin)]
    for motion in (u, angle):
        rest = np.linalg.lstsq(np.column_stack(modes), motion, rcond=None)[1]
        assert math.sqrt(float(rest[0]) / len(t)) < 1e-8
    assert np.max(result["plant.model.acceleration_error"]) > 0.01
    exact = load_scene("pendulum_small").set("plant.solver.method", "exact").run()
    assert np.max(np.abs(exact["plant.energy.residual"])) < 1e-12


def test_sampling_quickly_hardly_differs_from_continuous_feedback_and_slowly_swings():
    scene = load_scene("sampled_feedback")
    continuous = scene.copy().set("drive.sample.period", 0.0).run()["plant.pendulum.angle"]
    apart = {
        period: np.max(np.abs(one.run()["plant.pendulum.angle"] - continuous))
        for period, one in [(0.02, scene), (0.1, scene.with_variant("0.1 s"))]
    }
    size = np.ptp(continuous)
    assert apart[0.02] < 0.2 * size
    assert apart[0.1] > 2.0 * apart[0.02]


def costs(table: str) -> dict[str, list[float]]:
    """Numbers of each row of a table of the documentation, by method; infinity for a dash."""
    rows = re.findall(r"<tr><td>(\w+)(.*?)</tr>", table)
    cells = {method: re.findall(r'<td class="n">([^<]*)', rest) for method, rest in rows}
    return {
        method: [math.inf if "&" in text else float(text) for text in texts]
        for method, texts in cells.items()
    }


@pytest.mark.parametrize("name", ["bead_on_wire", "parabola_pendulum"])
def test_adaptive_is_the_cheapest_where_the_documentation_says(name):
    text = (fmus_directory() / name / "documentation.html").read_text(encoding="utf-8")
    tables = re.findall(r"(?s)<table>.*?</table>", text)
    assert tables
    for table in tables:
        found = costs(table)
        for column in range(1, 5):  # from 1e-6 on
            best = min(found, key=lambda method: found[method][column])
            assert best == "adaptive", (column, found)
        assert 1.5 < found["adaptive"][4] / found["adaptive"][0] < 3.0


def test_what_the_readme_teaches_of_methods_is_what_its_table_shows():
    text = EVIDENCE.read_text(encoding="utf-8")
    rows = re.findall(
        r"(?m)^\| .*`rk4`, `adaptive`, `implicit`.*$|^\| .*: the same methods.*$", text
    )
    rows += re.findall(r"(?m)^\| pendulum, `nonlinear`, (?:from u|started).*$", text)
    assert len(rows) == 4
    for row in rows:
        low, middle, high = (cell.split(",") for cell in row.strip("| ").split(" | ")[1:])
        chaotic = "chaotic" in row
        assert float(low[0]) / float(low[1]) == pytest.approx(0.8, abs=0.08)
        assert float(middle[0]) / float(middle[1]) == pytest.approx(
            2.2 if chaotic else 1.0, abs=0.15
        )
        assert chaotic or 1.9 <= float(high[0]) / float(high[1]) <= 4.0
