"""What a command does not need it does not load: `python tests/benchmarks start` has the times."""

from __future__ import annotations

import subprocess
import sys

import pytest

from curvebound.cosim import load_scene

HEAVY = {
    "numpy", "scipy", "mpmath", "sympy", "fmpy", "pythonfmu", "pint", "rich", "matplotlib", "shtab",
}  # fmt: skip


def loaded(*words: str) -> set[str]:
    """The heavy packages that a command has loaded when it is done."""
    script = (
        "import sys\n"
        "from curvebound.cli import main\n"
        "try:\n"
        "    main(sys.argv[1:])\n"
        "except SystemExit:\n"
        "    pass\n"
        "print(); print(*{name.partition('.')[0] for name in sys.modules})\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *words], capture_output=True, text=True, check=True
    )
    return HEAVY & set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    ("words", "allowed"),
    [
        pytest.param((), (), marks=pytest.mark.slow),
        pytest.param(("--help",), (), marks=pytest.mark.slow),
        pytest.param(("--version",), (), marks=pytest.mark.slow),
        pytest.param(("run", "--help"), (), marks=pytest.mark.slow),
        (("stability", "--help"), ()),
        pytest.param(("list",), (), marks=pytest.mark.slow),
        (("list", "--json"), ()),
        pytest.param(("list", "BeadOnWire"), ("rich",), marks=pytest.mark.slow),
        (("run", "bead_on_wire", "--stop", "0.1"), ("fmpy", "numpy")),
        pytest.param(
            ("run", "inverted_balance", "--stop", "0.1"), ("fmpy", "numpy"), marks=pytest.mark.slow
        ),
    ],
    ids=" ".join,
)
def test_nothing_heavy_is_loaded_that_is_not_needed(
    words: tuple[str, ...], allowed: tuple[str, ...]
) -> None:
    if "run" in words and "--help" not in words:
        load_scene(words[1]).check()  # builds the FMU, where the cache has none
    assert loaded(*words) <= set(allowed)
