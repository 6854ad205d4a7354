"""What a scene states that it needs, and what a run of it is found to miss."""

from __future__ import annotations

import math

import pytest

from curvebound.cosim import Needs, Scene
from curvebound.cosim.needs import errors_of, precise, unmet


def bead(**needs: object) -> Scene:
    scene = Scene("s", stop_time=2.0, step=0.1, needs=Needs(**needs))  # type: ignore[arg-type]
    start = {
        "model.formulation": "angle", "solver.method": "explicit_euler",
        "bead.angle_start": math.pi / 2,
    }  # fmt: skip
    return scene.add("bead", "BeadOnWire", start).record("bead.bead.*")


def test_the_error_is_the_distance_to_the_closed_form() -> None:
    """From the horizontal, r thetadot^2 = -2 g cos theta: the rate belongs to the angle."""
    scene = bead(errors={"bead.bead.angular_velocity": 1.0, "bead.bead.angle": 1.0})
    exact = precise(scene)
    assert exact is not None
    run = exact.run()
    rate, angle = run["bead.bead.angular_velocity"], run["bead.bead.angle"]
    assert rate**2 == pytest.approx(
        2 * 9.81 * abs(angle * 0 + [math.cos(a) for a in angle]), abs=1e-9
    )
    result = scene.run()
    errors = errors_of(scene, result)
    for path, error in errors.items():
        assert error == abs(result[path] - run[path]).max() > 1e-3


def test_each_need_that_is_missed_is_a_sentence() -> None:
    scene = bead(errors={"bead.bead.x": 1e-9, "bead.bead.y": 1.0}, budget=1e-12, frame_rate=30.0)
    result = scene.run()
    said = unmet(scene, result, errors_of(scene, result))
    assert len(said) == 3
    assert said[0].startswith("The error of bead.bead.x reaches")
    assert "its budget is 1e-12 s" in said[1]
    assert "10 points are recorded in a simulated second; it needs 30" in said[2]
    scene = bead(errors={"bead.bead.x": 1.0}, budget=10.0, frame_rate=10.0)
    assert unmet(scene, result, errors_of(scene, result)) == []


def test_without_a_precise_method_no_error_is_known(mass_fmu) -> None:
    scene = Scene("s", stop_time=1.0, step=0.1, needs={"a.x": 1e-9}).add("a", mass_fmu)
    assert precise(scene) is None
    assert errors_of(scene, scene.run()) == {}
