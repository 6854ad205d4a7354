"""Parts of the FMU's library in a program of their own."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

import curvebound.fmi

NATIVE = Path(curvebound.fmi.__file__).parent / "native"


@pytest.mark.parametrize("flags", [[], ["-D_WIN32", "-fshort-wchar"]], ids=["posix", "windows"])
def test_texts_locations_handles_and_direct_calls(
    compile_host: Callable[..., Path], tmp_path: Path, flags: list[str]
) -> None:
    program = compile_host("parts.c", tmp_path / "parts", f"-I{NATIVE}", *flags)
    done = subprocess.run([program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "")
