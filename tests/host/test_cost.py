"""What a call through the forwarding library costs: python -m pytest tests/host/test_cost.py -s"""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("system_python")]


def test_forwarding_costs_less_than_50_ns(compile_host, copy_of, bead, tmp_path):
    stub = compile_host("stub.c", tmp_path / "stub.so", "-O2", "-shared", "-fPIC")
    program = compile_host("cost.c", tmp_path / "cost", "-O2")
    fmu = copy_of(bead, "stubbed")
    shutil.copy(stub, fmu.binary.with_name("pythonfmu-export.so"))
    done = subprocess.run(
        [program, fmu.binary, stub, fmu.guid, fmu.uri],
        env={"PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    print(f"cost of forwarding: {done.stdout.strip()}")
    costs = [float(x) for x in re.findall(r"(-?[0-9.]+) ns", done.stdout)]
    assert len(costs) == 3
    assert max(costs) < 50.0
