"""A pytest plugin of the campaign: what each test runs, which FMUs it loads, how long it takes.

    python -m pytest -p watching ...        (with CAMPAIGN_WATCH = where to write JSON)

Coverage measures this process and, by its subprocess patch, those that the tests start. Compiled
code is not seen: of a test that loads an FMU, the FMU's name is noted instead.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy.fmi2
import pytest
from coverage import Coverage

SETTINGS = """\
[run]
source = {source}
data_file = {data}
parallel = true
context = ${{CAMPAIGN_TEST-}}
patch = subprocess
disable_warnings = no-data-collected,module-not-imported,couldnt-parse
"""

LONGEST = 60  # s that a slow test may take to be of use

_fmus: dict[str, set[str]] = {}
_seconds: dict[str, float] = {}
#: tests that failed, were skipped or took too long
_left: dict[str, str] = {}
_browser: set[str] = set()


def _noting(real: Any) -> Any:
    def made(self: Any, *arguments: Any, **named: Any) -> None:
        real(self, *arguments, **named)
        test = os.environ.get("CAMPAIGN_TEST")
        if test:
            _fmus.setdefault(test, set()).add(str(named.get("modelIdentifier", "")))

    return made


def pytest_configure() -> None:
    fmpy.fmi2.FMU2Slave.__init__ = _noting(fmpy.fmi2.FMU2Slave.__init__)  # type: ignore[method-assign]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.timeout(LONGEST), append=False)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    os.environ["CAMPAIGN_TEST"] = item.nodeid
    if "browser" in getattr(item, "fixturenames", ()):
        _browser.add(item.nodeid)
    current = Coverage.current()
    if current is not None:
        current.switch_context(item.nodeid)
    return (yield)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "call" and report.passed:
        _seconds[report.nodeid] = report.duration
    elif not report.passed:
        _left[report.nodeid] = report.outcome


def pytest_sessionfinish() -> None:
    found = {
        "seconds": _seconds,
        "left": _left,
        "fmus": {test: sorted(names) for test, names in _fmus.items()},
        "browser": dict.fromkeys(sorted(_browser), True),
    }
    Path(os.environ["CAMPAIGN_WATCH"]).write_text(json.dumps(found), encoding="utf-8")
