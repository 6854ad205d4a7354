"""Where ziglang is the only C compiler, it makes FMUs for both platforms as the others do."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest

pytest.importorskip("ziglang", reason="needs ziglang: pip install 'curvebound[compiler]'")

pytestmark = pytest.mark.slow

_MACHINE_OF = {b"\x7fELF": ".so", b"MZ": (".dll", ".pyd")}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("zig")
    empty = folder / "bin"
    empty.mkdir()
    environment = {**os.environ, "PATH": str(empty), "CURVEBOUND_CACHE": str(folder / "cache")}
    environment.pop("CC", None)
    command = [sys.executable, "-m", "curvebound", "build", "BeadOnWire", "--out", str(folder)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "on linux64 and win64, binary for linux64, binary for win64" in done.stdout
    return folder / "BeadOnWire.fmu"


def test_each_file_is_of_its_platform_and_runs_on_old_systems(made: Path) -> None:
    found = set()
    with zipfile.ZipFile(made) as archive:
        for name in archive.namelist():
            content = archive.read(name)
            for magic, suffixes in _MACHINE_OF.items():
                if name.endswith(suffixes):
                    assert content.startswith(magic), name
                    found.add(Path(name).suffix)
            if name.endswith(".so"):
                versions = re.findall(rb"GLIBC_(\d+)\.(\d+)", content)
                assert all((int(a), int(b)) <= (2, 17) for a, b in versions), name
                assert b"GLIBCXX" not in content
    assert found == {".so", ".dll", ".pyd"}


def test_it_gives_the_bits_of_other_compilers(made: Path, built: dict[str, Path]) -> None:
    ours, others = (fmpy.simulate_fmu(str(p)) for p in (made, built["BeadOnWire"]))
    for name in ours.dtype.names:
        assert (ours[name] == others[name]).all(), name
