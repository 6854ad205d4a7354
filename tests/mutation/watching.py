"""A pytest plugin of the campaign: what each test runs and how long it takes.

    python -m pytest -p watching ...        (with CAMPAIGN_WATCH = where to write JSON)

Coverage measures this process and, by its subprocess patch, those that the tests start, and the
interpreted sources of FMUs in them.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from coverage import Coverage

SETTINGS = """\
[run]
include =
    {tree}/src/curvebound/*
    {tree}/fmus/*
    */resources/curvebound_*
    */resources/*_system_*
data_file = {data}
parallel = true
context = ${{CAMPAIGN_TEST-}}
patch = subprocess
disable_warnings = no-data-collected,module-not-imported,couldnt-parse
"""

LONGEST = 20  # s that a test may take, watched, to be of use

_seconds: dict[str, float] = {}
#: tests that failed, were skipped or took too long
_left: dict[str, str] = {}
_browser: set[str] = set()
#: fixtures that tests share -> those tests
_shared: dict[str, list[str]] = {}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.timeout(LONGEST), append=False)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    _enter(item.nodeid)
    if "browser" in getattr(item, "fixturenames", ()):
        _browser.add(item.nodeid)
    for name, found in item._fixtureinfo.name2fixturedefs.items():  # type: ignore[attr-defined]
        for fixture in found:
            if fixture.scope != "function":
                _shared.setdefault(f"{fixture.baseid}::{name}", []).append(item.nodeid)
    return (yield)


def _enter(context: str) -> str:
    """Note what is run from now on as a test's or fixture's; returns whose it was before."""
    before = os.environ["CAMPAIGN_TEST"]
    os.environ["CAMPAIGN_TEST"] = context
    current = Coverage.current()
    if current is not None:
        current.switch_context(context)
    return before


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef[Any], request: Any) -> Iterator[object]:
    """What several tests share is run by all of them."""
    if fixturedef.scope == "function":
        return (yield)
    name = f"{fixturedef.baseid}::{fixturedef.argname}"
    before = _enter(name)
    try:
        return (yield)
    finally:
        _enter(before)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "call" and report.passed:
        _seconds[report.nodeid] = report.duration
    elif not report.passed:
        _left[report.nodeid] = report.outcome


def pytest_sessionfinish() -> None:
    found = {
        "seconds": _seconds,
        "left": _left,
        "shared": _shared,
        "browser": dict.fromkeys(sorted(_browser), True),
    }
    Path(os.environ["CAMPAIGN_WATCH"]).write_text(json.dumps(found), encoding="utf-8")
