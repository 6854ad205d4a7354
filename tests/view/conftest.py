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


@pytest.fixture(scope="session")
def kept_tab(browser: Browser) -> Tab:
    return browser.tab()


@pytest.fixture
def tab(kept_tab: Tab) -> Iterator[Tab]:
    """A blank page: always in the same tab, as a new one takes a process of its own.

    What stays with a tab (scripts for all of its pages) needs one from `new_tab`.
    """
    kept_tab.size(1280, 900)
    kept_tab.dark(False)
    kept_tab.errors.clear()
    kept_tab.requests.clear()
    yield kept_tab
    kept_tab.leave()
