"""linearize: against closed forms, differences of the FMU's own equations, and refusals."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from curvebound import linearize
from curvebound.cli import main
from curvebound.errors import CurveboundError


def test_modes_at_rest() -> None:
    values = np.linalg.eigvals(linearize("ParabolaPendulum", at={"slider.u": 0.0,
                                         "pendulum.angle": 0.0}, inputs=[]).A)  # fmt: skip
    found = sorted({round(abs(v.imag), 12) for v in values})
    assert found == pytest.approx([2.39719939786409, 5.78735129803610], abs=1e-11)


def test_a_bead_about_any_state() -> None:
    angle, rate, d, r = 0.7, 1.3, 0.2, 2.0
    model = linearize(
        "BeadOnWire",
        at={"bead.angle": angle, "bead.angular_velocity": rate, "bead.damping": d,
            "wire.radius": r},
        inputs=["bead.fx", "wire.ay"],
        outputs=["bead.x", "bead.vy", "constraint.force", "energy.total"],
    )  # fmt: skip
    g, s, c = 9.81, math.sin(angle), math.cos(angle)
    assert model.states == ("bead.angle", "bead.angular_velocity", "wire.y", "wire.vy")
    assert model.A[1] == pytest.approx([-g * c / r, -d, 0.0, 0.0], rel=1e-15)
    assert pytest.approx(np.array([[0, 0], [c / r, -s / r], [0, 0], [0, 1]]), rel=1e-15) == model.B
    assert model.C[0] == pytest.approx([r * c, 0, 0, 0], rel=1e-15)
    assert model.C[1] == pytest.approx([r * rate * c, r * s, 0, 1], rel=1e-15)
    assert model.C[2] == pytest.approx([g * s, -2 * r * rate, 0, 0], rel=1e-15)
    assert model.D[2] == pytest.approx([-s, -c], rel=1e-15)
    assert model.y0[0] == pytest.approx(r * s, rel=1e-15)
    assert model.units["constraint.force"] == "N"


def test_a_system_without_a_frame() -> None:
    """A bead on y = a x^2 that nothing moves: x'' = -2 a g x / (1 + 4 a^2 x^2) from rest."""
    folder = Path(__file__).parents[1] / "mechanics" / "systems" / "bead_on_parabola"
    at = {"wire.coefficient": 1.5, "bead.damping": 0.0, "bead.u_rate": 0.0}
    bottom = linearize(folder, {**at, "bead.u": 0.0})
    assert pytest.approx(np.array([[0.0, 1.0], [-3.0 * 9.81, 0.0]]), rel=1e-15) == bottom.A
    assert linearize(folder, {**at, "bead.u": 0.5}).rest[1] == pytest.approx(-1.5 * 9.81 / 3.25)


def test_an_equilibrium_is_found_and_held() -> None:
    push = {"bead.fx": 9.81, "bead.angle": 0.5}
    model = linearize("BeadOnWire", at=push, inputs=["bead.fx"], equilibrium=True)
    assert model.x0[0] == pytest.approx(math.pi / 4, rel=1e-15)
    assert np.abs(model.rest).max() < 1e-30
    with pytest.raises(CurveboundError, match="No equilibrium of BeadOnWire"):
        linearize("BeadOnWire", at={"gravity.y": 0.0, "bead.fx": 0.0}, equilibrium=True)


def test_the_linear_fidelity_is_its_own_linear_model() -> None:
    at = {"model.fidelity": "linear", "slider.u": 0.3, "pendulum.angle": -0.4}
    outputs = ["pendulum.tension", "parabola.fx"]
    here = linearize("ParabolaPendulum", at=at, inputs=["parabola.ax"], outputs=outputs)
    still = {**at, "slider.u": 0.0, "pendulum.angle": 0.0}
    rest = linearize("ParabolaPendulum", at=still, inputs=["parabola.ax"])
    assert pytest.approx(rest.A, rel=1e-15) == here.A


def test_files(tmp_path: Path) -> None:
    model = linearize("BeadOnWire", inputs=["bead.fx"])
    model.write(tmp_path / "bead.json")
    model.write(tmp_path / "bead.npz")
    found = json.loads((tmp_path / "bead.json").read_text())
    assert np.array(found["A"]) == pytest.approx(model.A, abs=0.0)
    with np.load(tmp_path / "bead.npz") as arrays:
        assert arrays["B"] == pytest.approx(model.B, abs=0.0)
        assert list(arrays["states"]) == list(model.states)
    with pytest.raises(CurveboundError, match="neither"):
        model.write(tmp_path / "bead.csv")
    assert {path.name for path in tmp_path.iterdir()} == {"bead.json", "bead.npz"}
    with pytest.raises(CurveboundError, match="cannot be written"):
        model.write(tmp_path / "bead.json" / "bead.npz")


@pytest.mark.parametrize("value", [math.nan, math.inf, "nan", "9**9**9"])
def test_a_state_that_is_no_number_is_refused(value: float | str) -> None:
    with pytest.raises(CurveboundError, match=r"bead\.angle.*(finite|not a number)"):
        linearize("BeadOnWire", {"bead.angle": value})


def test_a_system_without_mechanics_is_named() -> None:
    with pytest.raises(CurveboundError, match="ParabolaDrive states no mechanics"):
        linearize("ParabolaDrive")


def test_unknown_names_are_refused() -> None:
    with pytest.raises(CurveboundError, match=r"no bead\.angel to linearise at.*bead\.angle"):
        linearize("BeadOnWire", at={"bead.angel": 1.0})
    with pytest.raises(CurveboundError, match=r"no input wire\.az.*wire\.ax"):
        linearize("BeadOnWire", inputs=["wire.az"])


def test_the_command_cuts_nothing_and_says_about_which_state(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["linearize", "ParabolaPendulum", "--set", "slider.u=0"]
    assert main([*words, "--set", "pendulum.angle=170deg", "--equilibrium"]) == 0
    text = capsys.readouterr().out
    rows = [line.split() for line in text.splitlines()]
    assert ["x3", "pendulum.angle", "3.14159", "rad"] in rows
    assert ["x2", "-19.62", "0", "9.81", *"0000000"] in rows
    assert "no equilibrium" not in text
    assert "\u2026" not in text
    assert main([*words, "--input", "parabola.ax"]) == 0
    assert "x0 is no equilibrium, --equilibrium looks for one: slider.u_rate'" in (
        capsys.readouterr().out
    )


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("parabola.ax=1", "parabola.ax = 1: set it to 0, or choose inputs without it"),
        ("parabola.coefficient_rate_start=0.1", "parabola.coefficient_rate_start = 0.1: set it"),
        ("parabola.coefficient_acceleration=0.2", "parabola.coefficient_acceleration = 0.2"),
    ],
)
def test_what_moves_by_its_settings_has_no_equilibrium_and_writes_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], setting: str, said: str
) -> None:
    out = tmp_path / "model.npz"
    words = ["linearize", "ParabolaPendulum", "--set", setting, "--out", str(out)]
    assert main([*words, "--equilibrium"]) == 1
    heard = " ".join(capsys.readouterr().err.split())
    assert f"ParabolaPendulum has no equilibrium with {said}" in heard
    assert not out.exists()


def test_a_frame_that_is_pushed_and_no_input_has_a_relative_equilibrium() -> None:
    at = {"wire.ax": 9.81, "bead.angle": -0.5}
    model = linearize("BeadOnWire", at=at, inputs=["bead.fx"], equilibrium=True)
    assert model.x0[0] == pytest.approx(-math.pi / 4, rel=1e-15)
