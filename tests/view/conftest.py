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


@pytest.fixture(scope="module")
def module_tab(kept_tab: Tab) -> Iterator[Tab]:
    """The same, left when the tests of a file are done: a page costs something at rest, too."""
    yield kept_tab
    kept_tab.leave()


@pytest.fixture
def tab(module_tab: Tab, request: pytest.FixtureRequest) -> Tab:
    """A page to open others in: always the same tab, as a new one takes a process of its own.

    Small, as each pixel costs, unless the module's SIZE says otherwise. What stays with a tab
    (scripts for all of its pages) needs one from `new_tab`.
    """
    module_tab.size(*getattr(request.module, "SIZE", (800, 600)))
    module_tab.dark(False)
    module_tab.errors.clear()
    module_tab.requests.clear()
    return module_tab
