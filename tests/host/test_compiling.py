"""Compiling the FMUs' binary: the same bytes each time, an honest reason where it fails."""

from __future__ import annotations

import pytest

from curvebound.compiling import toolchain
from curvebound.fmi import binaries


@pytest.fixture
def fresh_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("CURVEBOUND_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture(autouse=True)
def nothing_shipped(monkeypatch, tmp_path):
    """As in a checkout that was never installed."""
    monkeypatch.setattr(binaries, "compiled_directory", lambda: tmp_path / "shipped")


def compiled_or_skip():
    library = binaries.compile_binary()
    if library is None:
        pytest.skip(binaries.why_not())
    return library


@pytest.fixture
def before():
    """The library as it is in the cache, from another time."""
    return compiled_or_skip()


def test_the_same_bytes_each_time_and_nothing_left_behind(before, fresh_cache):
    library = compiled_or_skip()
    assert fresh_cache in library.parents
    assert binaries.why_not() == ""
    assert sorted(p.name for p in library.parent.iterdir()) == ["contents.json", library.name]
    written = library.stat().st_mtime_ns
    assert binaries.compile_binary() == library
    assert library.stat().st_mtime_ns == written, "compiled again although it was cached"
    assert library != before
    assert library.read_bytes() == before.read_bytes()


def test_no_compiler_no_library(fresh_cache, monkeypatch):
    monkeypatch.setattr(binaries, "compiler_for", lambda target: None)
    assert binaries.compile_binary() is None
    assert binaries.why_not() == "no C compiler for linux64 found"


def test_a_compiler_that_fails_is_a_reason_and_not_an_error(fresh_cache, monkeypatch, tmp_path):
    if toolchain.compiler_for("linux64") is None:
        pytest.skip("no C compiler here")
    broken = tmp_path / "cc"
    broken.write_text('#!/bin/sh\n[ "$1" = --version ] || { echo out of order >&2; exit 1; }\n')
    broken.chmod(0o755)
    monkeypatch.setattr(binaries, "compiler_for", lambda target: [str(broken)])
    monkeypatch.setenv("CURVEBOUND_CACHE", str(fresh_cache.with_name("other")))
    assert binaries.compile_binary() is None
    assert "out of order" in binaries.why_not()
    assert list(fresh_cache.with_name("other").glob("**/*.so")) == []
    monkeypatch.undo()
    assert binaries.compile_binary() is not None
    assert binaries.why_not() == ""


def test_a_compiler_for_another_system_is_none_for_this(monkeypatch):
    monkeypatch.setattr(toolchain, "HERE", "")
    monkeypatch.setattr(toolchain.importlib.util, "find_spec", lambda name: None)
    assert toolchain.compiler_for("linux64") is None
    assert binaries.compile_binary() is None
    assert "linux64" in binaries.why_not()


@pytest.mark.slow
def test_what_came_with_the_package_needs_no_compiler(fresh_cache, monkeypatch, tmp_path):
    library = compiled_or_skip()
    (tmp_path / "shipped").mkdir()
    reasons = list(binaries.write_shipped(tmp_path / "shipped"))
    monkeypatch.setattr(binaries, "compiler_for", lambda target: None)
    monkeypatch.setenv("CURVEBOUND_CACHE", str(fresh_cache.with_name("other")))
    found = binaries.compile_binary()
    assert found is not None
    assert found.parent == tmp_path / "shipped"
    assert found.read_bytes() == library.read_bytes()
    assert binaries.why_not() == ""
    for name in binaries.PLATFORMS:
        named = [reason for reason in reasons if name in reason]
        assert bool(named) == (binaries.compile_binary(name) is None)
