"""Random sequences of FMI calls, the FMU's binary under the address sanitizer.

Always the same ones, unless FUZZ_SEED gives another seed ("random" draws one). The seed is printed,
and a failure names the sequence.
"""

from __future__ import annotations

import os
import random
import shutil
import subprocess

import pytest

from curvebound.fmi.binaries import compile_sources

pytestmark = pytest.mark.usefixtures("system_python")

SANITIZE = ("-fsanitize=address", "-fno-omit-frame-pointer", "-g", "-O0")


@pytest.fixture(scope="module")
def fuzz_program(compile_host, tmp_path_factory):
    target = tmp_path_factory.mktemp("fuzz") / "fuzz"
    return compile_host("fuzz.c", target, *SANITIZE, "-lm")


@pytest.fixture(scope="module")
def sanitized(fmus, tmp_path_factory):
    """The FMUs with a binary that the address sanitizer watches."""
    library = tmp_path_factory.mktemp("sanitized") / "native.so"
    compile_sources(library, extra=("-Wl,-z,undefs", *SANITIZE))
    result = {}
    for name, fmu in fmus.items():
        folder = tmp_path_factory.mktemp(name)
        shutil.copytree(fmu.folder, folder, dirs_exist_ok=True)
        result[name] = type(fmu)(folder, fmu.guid, fmu.identifier, fmu.vr, fmu.variables)
        shutil.copy(library, result[name].binary)
    return result


def letter(variable):
    kinds = {"Real": "R", "Integer": "I", "Enumeration": "I", "String": "S", "Boolean": "B"}
    return next(kinds[child.tag] for child in variable if child.tag in kinds)


def fuzz(program, fmus, name, count, tmp_path):
    fmu = fmus[name]
    other = next(f for n, f in fmus.items() if n != name)
    variables = tmp_path / "variables.txt"
    lines = [
        f"{v.get('valueReference')} {letter(v)} {v.get('causality')[0]}" for v in fmu.variables
    ]
    variables.write_text("\n".join(lines) + "\n")
    seed = os.environ.get("FUZZ_SEED", "20")
    if seed == "random":
        seed = str(random.SystemRandom().randrange(2**32))
    print(f"FUZZ_SEED={seed}")
    done = subprocess.run(
        [
            *(str(program), seed, "0", str(count), name),
            *(str(fmu.binary), fmu.guid, fmu.uri, str(variables)),
            *(str(other.binary), other.guid, other.uri),
        ],
        env={"PATH": "/usr/bin:/bin", "ASAN_OPTIONS": "detect_leaks=0:abort_on_error=1"},
        capture_output=True,
        text=True,
        timeout=3000,
    )
    print(done.stdout)
    assert done.returncode == 0, f"seed {seed}\n{done.stdout[-3000:]}\n{done.stderr[-6000:]}"
    assert f"{name}: {count} sequences" in done.stdout


def test_some_hundred_sequences(fuzz_program, sanitized, tmp_path):
    fuzz(fuzz_program, sanitized, "ParabolaPendulum", 200, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["BeadOnWire", "ParabolaPendulum", "ParabolaDrive"])
def test_twenty_thousand_sequences(fuzz_program, sanitized, name, tmp_path):
    fuzz(fuzz_program, sanitized, name, 20000, tmp_path)
