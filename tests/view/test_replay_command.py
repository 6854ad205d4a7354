"""`curvebound replay`: files in, one page out."""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from motions import bead, pendulum

from curvebound.cli import main
from curvebound.cosim import write_csv
from curvebound.fmi.build import build
from curvebound.fmi.folder import find


def model(page: Path) -> dict[str, Any]:
    found = re.search(r'id="model">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
    assert found
    return dict(json.loads(found[1]))


def test_one_result_beside_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_csv(bead(1.0, 0.01), tmp_path / "bead.csv")
    assert main(["replay", str(path)]) == 0
    page = tmp_path / "bead.html"
    assert str(page) in capsys.readouterr().out.replace("\n", "")
    assert [result["label"] for result in model(page)["results"]] == ["bead"]


def test_labels_titles_and_pictures(tmp_path: Path) -> None:
    one = write_csv(bead(1.0, 0.01), tmp_path / "one" / "result.csv")
    two = write_csv(bead(1.0, 0.02), tmp_path / "two" / "result.csv")
    out = tmp_path / "page.html"
    assert main(["replay", str(one), str(two), "--out", str(out), "--title", "Both"]) == 0
    assert [result["label"] for result in model(out)["results"]] == ["one/result", "two/result"]
    assert model(out)["title"] == "Both"
    png, gif = tmp_path / "a.png", tmp_path / "a.gif"
    names = [f"h = 0.01={one}", f"h = 0.02={two}"]
    assert (
        main(
            [
                "replay",
                *names,
                "--out",
                str(out),
                "--picture",
                str(png),
                "--gif",
                str(gif),
                "--seconds",
                "1",
                "--fps",
                "5",
            ]
        )
        == 0
    )
    assert [result["label"] for result in model(out)["results"]] == ["h = 0.01", "h = 0.02"]
    assert png.stat().st_size > 5000
    assert gif.stat().st_size > 5000


def test_bodies_of_two_kinds_in_one_page(tmp_path: Path) -> None:
    one = write_csv(bead(1.0, 0.01), tmp_path / "bead.csv")
    two = write_csv(pendulum(1.0, 0.01), tmp_path / "pendulum.csv")
    assert main(["replay", str(one), str(two)]) == 0
    found = model(tmp_path / "bead.html")
    assert [actor["kind"] for actor in found["actors"]] == ["BeadOnWire", "ParabolaPendulum"]
    assert not any(plot["title"].startswith("Distance") for plot in found["plots"])


@pytest.mark.parametrize(
    ("text", "said"),
    [("", "is empty"), ("x,y\n1,2\n", "no column"), ("time,a\n0,1\n1,2,3\n2,2\n", "Line 3")],
)
def test_a_broken_file_is_one_paragraph_and_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    path = tmp_path / "broken.csv"
    path.write_text(text)
    assert main(["replay", str(path)]) == 2
    heard = " ".join(capsys.readouterr().err.split())
    assert said in heard
    assert "Traceback" not in heard
    assert not (tmp_path / "broken.html").exists()


def test_a_page_is_never_written_over_a_result(tmp_path: Path, capsys) -> None:
    for name in ("a.csv", "b.html"):
        (tmp_path / name).write_text("time,x\n0,1\n1,2\n")
    for given in (["a.csv", "--out", "a.csv"], ["b.html"]):
        words = [word if word == "--out" else str(tmp_path / word) for word in given]
        with suppress(SystemExit):
            assert main(["replay", *words]) == 1
        assert "a.csv' does not end in .html" in (said := capsys.readouterr().err) or (
            "b.html is one of the results" in said
        )
    for name in ("a.csv", "b.html"):
        assert (tmp_path / name).read_text().startswith("time,x")


def test_too_many_results_and_a_place_that_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(write_csv(bead(0.1, 0.01), tmp_path / "bead.csv"))
    assert main(["replay", *(f"{k}={path}" for k in range(9))]) == 1
    assert "at most 8" in " ".join(capsys.readouterr().err.split())
    assert main(["replay", path, "--out", str(tmp_path / "bead.csv" / "page.html")]) == 2
    assert "cannot be written" in " ".join(capsys.readouterr().err.split())


@pytest.mark.usefixtures("short_reference")
@pytest.mark.parametrize("how", ["FMU", "folder", "beside"])
def test_a_system_from_elsewhere_is_drawn(tmp_path: Path, how: str) -> None:
    """What is told, or lies beside the result, goes before what is shipped."""
    folder = tmp_path / ("systems" if how == "beside" else "mine") / "loop"
    shutil.copytree(find("BeadOnWire").path, folder)
    source = folder / "fmu.py"
    source.write_text(source.read_text().replace('"BeadOnWire"', '"Loop"'))
    drawing = folder / "drawing.py"
    text = drawing.read_text().replace('"bead"', '"ring"')
    drawing.write_text(text.replace('mass_arrows("ring")', 'mass_arrows("bead", "ring")'))
    data = bead(1.0, 0.01)
    arguments = ["replay", str(write_csv(data, tmp_path / "own.csv"))]
    if how == "FMU":
        made = build(folder, tmp_path, compiled=False).path
        arguments += ["--system", str(made)]
    elif how == "folder":
        arguments += ["--system", str(folder)]
    assert main(arguments) == 0
    (actor,) = model(tmp_path / "own.html")["actors"]
    assert actor["kind"] == "Loop"
    assert [point["name"] for point in actor["points"]] == ["ring"]


def test_an_fmu_of_another_tool_has_no_drawing(fmus: Path, tmp_path: Path, capsys) -> None:
    bare = tmp_path / "bare.fmu"
    with zipfile.ZipFile(fmus / "ParabolaDrive.fmu") as old, zipfile.ZipFile(bare, "w") as new:
        for name in old.namelist():
            if name != "resources/drawing.json":
                new.writestr(name, old.read(name))
    path = str(write_csv(bead(0.1, 0.01), tmp_path / "bead.csv"))
    assert main(["replay", path, "--system", str(bare)]) == 1
    assert "carries no drawing" in " ".join(capsys.readouterr().err.split())
