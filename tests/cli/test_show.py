"""`curvebound show`, and what the command line says to words that it does not know."""

from __future__ import annotations

import pytest

from curvebound import __version__
from curvebound.cli import main


@pytest.fixture(autouse=True)
def _wide(monkeypatch: pytest.MonkeyPatch) -> None:
    """A terminal that folds no line."""
    monkeypatch.setenv("COLUMNS", "250")


def shown(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert main(["show", *words]) == 0
    return " ".join(capsys.readouterr().out.split())


def test_a_scene_shows_what_it_joins_and_needs(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "inverted_balance")
    assert "0 to 20 s in macro steps of 0.01 s, gauss_seidel" in text
    assert "drive ParabolaDrive" in text
    assert "reference.pendulum_angle = 3.14159" in text
    assert "drive.parabola.ax plant.parabola.ax" in text
    assert "plant.pendulum.fx varies with time" in text
    assert "plant.slider.u error below 0.01 m" in text


def test_a_variable_shows_unit_range_and_the_numbers_of_its_items(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = shown(capsys, "solver.method")
    assert "BeadOnWire solver.method: time integration method" in text
    assert "start rk4" in text
    assert "4 adaptive" in text
    assert "unit kg start 1 range 0 to inf" in shown(capsys, "bead.mass")
    assert "changes while running" in shown(capsys, "limit.acceleration")


def test_an_fmu_shows_its_variables(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "ParabolaDrive")
    assert "ParabolaDrive: Controller that drives" in text
    assert "reference.parabola_x tunable parameter m 0 set point of parabola.x" in text


def test_an_unknown_name_gets_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "solver.metod"]) == 1
    assert "did you mean solver.method" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "nearest"),
    [(["shwo", "x"], "show"), (["run", "bead_on_wire", "--algorithm", "jacoby"], "jacobi")],
)
def test_a_misspelt_word_gets_the_nearest(
    words: list[str], nearest: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 2
    assert f"did you mean {nearest}?" in capsys.readouterr().err


def test_nothing_asked_is_help_and_v_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert "usage: curvebound" in capsys.readouterr().out
    with pytest.raises(SystemExit) as stop:
        main(["-V"])
    assert stop.value.code == 0
    assert capsys.readouterr().out == f"curvebound {__version__}\n"
