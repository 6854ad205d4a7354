"""What the binary itself adds to a call: python -m pytest tests/host/test_cost.py -s"""

from __future__ import annotations

import re
import subprocess

import pytest

pytestmark = pytest.mark.slow


def test_the_binary_adds_less_than_25_ns(compile_host, bead, tmp_path):
    stub = compile_host("stub.c", tmp_path / "stub.so", "-O2", "-shared", "-fPIC")
    program = compile_host("cost.c", tmp_path / "cost", "-O2")
    done = subprocess.run(
        [program, bead.binary, stub, bead.guid, bead.uri],
        env={"PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    print(f"the binary's share: {done.stdout.strip()}")
    costs = [float(x) for x in re.findall(r"(-?[0-9.]+) ns", done.stdout)]
    assert len(costs) == 3
    assert max(costs) < 25.0
