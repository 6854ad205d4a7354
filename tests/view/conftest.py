"""A browser for the tests of the pages, and pages for it."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator

import pytest

# test modules are imported without packages (importmode=importlib); their helpers live here
from browsing import Browser, Tab


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if program is None:
        pytest.skip("Chromium is missing: `bash .ci/browser` installs it")
    pytest.importorskip("websockets", reason="websockets is missing: pip install websockets")
    started = Browser(program, tmp_path_factory.mktemp("profile"))
    yield started
    started.close()


@pytest.fixture
def new_tab(browser: Browser) -> Iterator[Callable[[], Tab]]:
    tabs: list[Tab] = []

    def make() -> Tab:
        tabs.append(browser.tab())
        return tabs[-1]

    yield make
    for tab in tabs:
        tab.close()


@pytest.fixture
def tab(new_tab: Callable[[], Tab]) -> Tab:
    made = new_tab()
    made.size(1280, 900)
    made.dark(False)
    return made
