"""Parts of the FMU's library in a program of their own."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import curvebound.fmi

NATIVE = Path(curvebound.fmi.__file__).parent / "native"


def test_texts_locations_and_handles(compile_host: Callable[..., Path], tmp_path: Path) -> None:
    program = compile_host("parts.c", tmp_path / "parts", f"-I{NATIVE}")
    done = subprocess.run([program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "")
