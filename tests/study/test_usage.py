"""Wrong usage of study, tune and sweep: said in a line, before anything is run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from curvebound.cli import main
from curvebound.cosim import load_scene
from curvebound.study.reference import reference

pytest.importorskip("mpmath")
TUNE = ["tune", "bead_on_wire"]


@pytest.mark.parametrize(
    "words",
    [
        *([*TUNE, "--budget", text] for text in ("0", "-1", "nan")),
        *([*TUNE, "--frame-rate", text] for text in ("0", "-5", "inf")),
        *([*TUNE, "--limit", text] for text in ("0", "-1", "nan")),
        ["study", "bead_on_wire", "--limit", "-1"],
        ["sweep", "bead_on_wire", "--seed", "-1"],
        [*TUNE, "--error", "inf"],
    ],
    ids=" ".join,
)
def test_a_number_or_option_without_sense_is_wrong_usage(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 2
    assert f"argument {words[-2]}" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["study", "bead_on_wire", "--quick", "--no-plots", "--out", "{}"],
        ["sweep", "bead_on_wire", "--vary", "bead.bead.damping=0:1:2", "--out", "{}/x.csv"],
    ],
    ids=lambda words: words[0],
)
def test_a_folder_that_is_a_file_is_named(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_text("")
    assert main([word.format(file) for word in words]) == 2
    err = " ".join(capsys.readouterr().err.split())
    assert "cannot be written" in err
    assert "Traceback" not in err


def test_an_output_that_nothing_defines_names_others(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(reference, "collocate", None)  # nothing is computed
    assert main([*TUNE, "--error", "foo.bar=1e-3"]) == 1
    err = " ".join(capsys.readouterr().err.split())
    assert "bead.bead.x" in err
    assert "--output" not in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--vary", "bead.bead.damping=a,b"], "'a' is not a number"),
        (["--vary", "bead.bead.damping=0:1:3", "--set", "bead.bead.damping=3"], "would be ignored"),
        (["--vary", "bead.bead.damping=0:1:3", "--map"], "needs two parameters"),
    ],
    ids=["word", "set", "map"],
)
def test_a_sweep_without_sense_leaves_an_earlier_one_alone(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "x.csv"
    out.write_text("an earlier one")
    assert main(["sweep", "bead_on_wire", *words, "--out", str(out), "--restart"]) == 1
    assert message in " ".join(capsys.readouterr().err.split())
    assert out.read_text() == "an earlier one"


def test_two_bounds_of_one_output_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*TUNE, "--error", "1e-3", "--error", "1e-5"]) == 1
    assert "Two bounds" in capsys.readouterr().err


@pytest.mark.usefixtures("timed_once")
def test_a_choice_for_programs_is_one_that_they_can_make(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = tmp_path / "short.py"
    script.write_text(
        "from curvebound.cosim import load_scene\n"
        "scene = load_scene('bead_on_wire')\n"
        "scene.set('stop_time', 1.0).set('bead.bead.damping', 0.1)\n"
    )
    words = ["tune", str(script), "--error", "bead.bead.x=1e-3", "--json"]
    keep = ["bead.model.formulation=angle"]
    assert main([*words, *(["--keep", *keep])]) == 0
    told = capsys.readouterr()
    [choice] = json.loads(told.out)
    assert choice["units"]["bead.bead.x"] == "m"
    assert choice["start"]["bead.model.formulation"] == "angle"
    assert "bead.bead.x within 0.001 m" in told.err
    scene = load_scene(script)
    for path, value in {**choice["start"], "step": choice["step"]}.items():
        scene.set(path, value)
    assert scene.run().complete
