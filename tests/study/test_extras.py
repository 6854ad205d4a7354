"""What needs an extra says so before it does anything else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from curvebound import linearize
from curvebound.cli import main
from curvebound.errors import CurveboundError
from curvebound.study import extras
from curvebound.study.regulator import gains


@pytest.mark.parametrize(
    "call",
    [lambda: gains(None), lambda: linearize("BeadOnWire")],  # type: ignore[arg-type]
    ids=["gains", "linearize"],
)
def test_functions(call: Callable[[], Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(extras._NEEDED, "study", ("numpy", "no_such_one", "nor_this"))
    with pytest.raises(CurveboundError) as raised:
        call()
    assert str(raised.value) == (
        "This needs no_such_one and nor_this, not installed here. "
        "Install it with `pip install 'curvebound[study]'`."
    )


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        ("study", ["study", "bead_on_wire"]),
        ("study", ["tune", "bead_on_wire"]),
        ("plots", ["study", "bead_on_wire"]),
        ("plots", ["stability", "bead_on_wire", "--vary", "bead.bead.mass=1:2:2"]),
        ("live", ["live", "bead_on_wire"]),
    ],
    ids=lambda given: given if isinstance(given, str) else given[0],
)
def test_commands(
    extra: str,
    words: list[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(extras._NEEDED, extra, ("no_such_one",))
    assert main(words) != 0
    said = " ".join(capsys.readouterr().err.split())
    assert "This needs no_such_one" in said
    assert f"pip install 'curvebound[{extra}]'" in said
    assert not list(tmp_path.iterdir())
