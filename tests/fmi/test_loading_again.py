"""Simulated again and again in one process, each time from the file: nothing is left behind."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

_LOOP = """
import gc, json, os, sys, tempfile
from pathlib import Path
import fmpy

path, count, folder = sys.argv[1], int(sys.argv[2]), sys.argv[3] == "folder"
tempfile.tempdir = sys.argv[4]
what = fmpy.extract(path) if folder else path


def measure():
    gc.collect()
    with open("/proc/self/statm") as statm, open("/proc/self/maps") as maps:
        return (int(statm.read().split()[1]) * os.sysconf("SC_PAGESIZE"), len(maps.readlines()),
                len(sys.path), len(sys.path_importer_cache), len(sys.modules),
                len(os.listdir(tempfile.tempdir)))


def one():
    result = fmpy.simulate_fmu(what, stop_time=0.02, output_interval=0.01, validate=False)
    return [result[name][-1] for name in result.dtype.names]


first = one()
for _ in range(9):
    one()
before = measure()
for _ in range(count - 10):
    assert one() == first
print(json.dumps([before, measure()]))
"""


def loop(path: Path, count: int, how: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _LOOP, str(path), str(count), how, str(tmp_path)],
        env={**os.environ, "MALLOC_TRIM_THRESHOLD_": "0"},
        capture_output=True,
        text=True,
        timeout=1200,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    before, after = json.loads(done.stdout)
    assert after[1] <= before[1] + 3, "memory maps"
    assert after[2:] == before[2:], "sys.path, its cache, modules, temporary files"
    # 273 kB a time made 540 MB
    assert after[0] - before[0] < 4e6 + 500.0 * count, "resident memory"


@pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
@pytest.mark.parametrize("how", ["file", pytest.param("folder", marks=pytest.mark.slow)])
def test_dozens_of_times(fmus: Path, how: str, tmp_path: Path) -> None:
    loop(fmus / "BeadOnWire.fmu", 28, how, tmp_path)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
@pytest.mark.parametrize(
    ("name", "count"), [("BeadOnWire", 2010), ("ParabolaPendulum", 410), ("ParabolaDrive", 410)]
)
def test_two_thousand_times(fmus: Path, name: str, count: int, tmp_path: Path) -> None:
    loop(fmus / f"{name}.fmu", count, "file", tmp_path)
