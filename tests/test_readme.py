"""What the README shows runs as it stands there."""

from __future__ import annotations

import os
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from curvebound.cli import main

README = Path(__file__).parents[1] / "README.md"
TEXT = README.read_text(encoding="utf-8")
#: shell blocks after the two that .ci/run runs; that of a new system has tests of its own
COMMANDS = [
    block
    for block in re.findall(r"(?ms)^```sh\n(.*?)^```$", TEXT)[2:]
    if "bead_on_parabola" not in block
]
BLOCKS = re.findall(r"(?ms)^```python\n(.*?)^```$", TEXT)


def test_the_readme_shows_code() -> None:
    assert BLOCKS


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_python_of_the_readme_runs(
    number: int,
    fmus: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Each block is a program of its own; it finds the FMUs in build/."""
    (tmp_path / "build").symlink_to(fmus)
    script = tmp_path / "block.py"
    script.write_text(BLOCKS[number], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    said = capsys.readouterr().out
    expected = re.findall(r"# prints (.*)$", BLOCKS[number], re.MULTILINE)
    for text in expected:
        assert text in said


def test_the_first_two_shell_blocks_are_one_line_each() -> None:
    blocks = re.findall(r"(?ms)^```sh\n(.*?)^```$", TEXT)
    assert len(blocks) >= 2
    for block in blocks[:2]:
        assert len(block.strip().splitlines()) == 1


def in_a_shell(lines: str, folder: Path) -> None:
    """Run lines as somebody does whose environment is active."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", lines], cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PATH": path},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr


@pytest.mark.usefixtures("points_here", "one_reference")
@pytest.mark.parametrize("number", range(len(COMMANDS)))
def test_commands_of_the_readme_run(
    number: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("pyarrow")
    monkeypatch.chdir(tmp_path)
    for line in COMMANDS[number].strip().splitlines():
        program, *words = shlex.split(line, comments=True)
        assert program == "curvebound"
        assert main(words) == 0
    for written in re.findall(r"--(?:out|replay|picture) (\S+\.\w+)", COMMANDS[number]):
        assert (tmp_path / written).is_file(), written


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(COMMANDS)))
def test_commands_of_the_readme_run_in_a_shell(number: int, tmp_path: Path) -> None:
    in_a_shell(COMMANDS[number], tmp_path)


@pytest.mark.slow
def test_the_workflow_of_the_readme_builds_checks_and_leaves_artefacts(tmp_path: Path) -> None:
    """Its commands by hand, in a repository that holds a system of one's own."""
    (workflow,) = re.findall(r"(?ms)^```yaml\n(.*?)^```$", TEXT)
    install, *commands = re.findall(r"(?m)^ +- run: (.*)$", workflow)
    assert install.startswith("pip install")
    in_a_shell("curvebound new my_system", tmp_path)
    in_a_shell("\n".join(commands), tmp_path)
    assert (tmp_path / "build" / "MySystem.fmu").is_file()
    report = (tmp_path / "build" / "check.xml").read_text(encoding="utf-8")
    assert report.count("<testsuite ") == 2
    assert "<failure" not in report


def test_the_readme_is_short_and_names_files_that_are_there() -> None:
    assert len(TEXT.splitlines()) <= 320
    for address in re.findall(r"\]\((?!http|#)([^)]*)\)", TEXT):
        assert (README.parent / address).is_file(), address
