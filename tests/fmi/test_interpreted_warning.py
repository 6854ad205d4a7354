"""An FMU that runs interpreted says so once in a process: this Python, the others, the remedy."""

from __future__ import annotations

import platform
from pathlib import Path

import pytest

import curvebound
from curvebound.fmi import slave

REASON = "no extension for this platform"


@pytest.fixture(autouse=True)
def not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curvebound, "NOT_COMPILED", REASON, raising=False)
    monkeypatch.setattr(slave, "_SAID", set())


def test_once_for_each_kind_of_fmu(tmp_path: Path) -> None:
    first = slave.interpreted("BeadOnWire", str(tmp_path))
    assert first.startswith("BeadOnWire runs interpreted")
    assert platform.python_version() in first
    assert slave.interpreted("BeadOnWire", str(tmp_path)) == ""
    assert slave.interpreted("ParabolaDrive", str(tmp_path)).startswith("ParabolaDrive runs")


def test_what_it_is_compiled_for_and_the_remedy(tmp_path: Path) -> None:
    without = slave.interpreted("A", str(tmp_path))
    assert "built without compiled code" in without
    assert "C compiler" in without
    (tmp_path / "_compiled.abi3.so").touch()
    (tmp_path / "_compiled.pyd").touch()
    both = slave.interpreted("B", str(tmp_path))
    assert REASON in both
    assert "linux64 and win64" in both
    assert "CPython 3.10" in both


def test_nothing_is_said_where_it_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curvebound, "NOT_COMPILED", "")
    assert slave.interpreted("C", None) == ""
