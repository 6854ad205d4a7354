"""What the README shows runs as it stands there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

README = Path(__file__).parents[1] / "README.md"
BLOCKS = re.findall(r"(?ms)^```python\n(.*?)^```$", README.read_text(encoding="utf-8"))


def test_the_readme_shows_code() -> None:
    assert BLOCKS


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_python_of_the_readme_runs(number: int, fmus: Path, tmp_path: Path) -> None:
    """Each block is a program of its own; it finds the FMUs in build/."""
    (tmp_path / "build").symlink_to(fmus)
    script = tmp_path / "block.py"
    script.write_text(BLOCKS[number], encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    expected = re.findall(r"# prints (.*)$", BLOCKS[number], re.MULTILINE)
    for text in expected:
        assert text in done.stdout


def test_the_first_two_shell_blocks_are_one_line_each() -> None:
    blocks = re.findall(r"(?ms)^```sh\n(.*?)^```$", README.read_text(encoding="utf-8"))
    assert len(blocks) >= 2
    for block in blocks[:2]:
        assert len(block.strip().splitlines()) == 1
