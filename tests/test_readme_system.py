"""README's 'Make your own system', done as it says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from curvebound.checks import kernel_follows_mechanics
from curvebound.cli import main
from curvebound.cosim import load_scene

README = Path(__file__).parents[1] / "README.md"
#: commands that take minutes
LONG = ("study", "tune", "stability", "sample")


def section() -> str:
    return README.read_text(encoding="utf-8").split("## Make your own system")[1].split("\n## ")[0]


def files() -> dict[str, str]:
    return dict(re.findall(r"```python\n# (\S+)\n(.*?)```", section(), re.DOTALL))


def commands() -> list[list[str]]:
    (block,) = re.findall(r"```sh\n(.*?)```", section(), re.DOTALL)
    return [line.split("#")[0].split()[1:] for line in block.splitlines()]


@pytest.fixture
def written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    assert main(["new", "bead_on_parabola"]) == 0
    for name, text in files().items():
        assert (tmp_path / name).is_file(), "what `curvebound new` writes, and nothing else"
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_it_takes_thirty_lines_and_no_derivative_by_hand() -> None:
    lines = [line for text in files().values() for line in text.splitlines() if line.strip()]
    assert len(lines) <= 30
    assert not re.search(r"\bdiff|\bcos\(|acceleration", "".join(files().values()))


@pytest.mark.usefixtures("interpreting", "short_reference")
def test_what_it_says_works(written: Path) -> None:
    for command in commands():
        if command[0] not in LONG:
            assert main(command) == 0
    assert (written / "build" / "BeadOnParabola.fmu").is_file()
    page = (written / "pushed.html").read_text()
    assert '"kind":"BeadOnParabola"' in page
    kernel_follows_mechanics(written / "bead_on_parabola")
    scene = load_scene(written / "bead_on_parabola" / "scene.py")
    scene.record("wire.*")
    result = scene.run()
    assert np.abs(result["wire.energy.residual"]).max() < 1e-5
    u, y = result["wire.bead.u"], result["wire.bead.y"]
    assert np.abs(y - 0.5 * u**2).max() < 1e-12
    assert np.ptp(result["wire.energy.total"]) > 0.1


@pytest.mark.slow
def test_what_takes_minutes_works_too(written: Path) -> None:
    long = [command for command in commands() if command[0] in LONG]
    assert {command[0] for command in long} == set(LONG)
    for command in long:
        assert main(command) == 0
    scene = load_scene(written / "bead_on_parabola" / "scene.py")
    scene.record("wire.*")
    assert np.abs(scene.run()["wire.energy.residual"]).max() < 1e-3
