"""The live page that plays for a while: nothing grows, no error is said, time goes on.

How fast it is, `python tests/benchmarks live` measures.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmarks.worker import resident
from browsing import Tab
from serving import served

from curvebound.cosim import scene_names
from curvebound.view.live.plan import Plan

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", scene_names())
def test_it_plays_on(tab: Tab, plan_of: Callable[[str], Plan], tmp_path: Path, name: str) -> None:
    with served(plan_of(name), tmp_path) as serving:
        tab.visit(f"{serving.address}#play=1")
        tab.wait("curvebound.time > curvebound.model.start + 2")
        held, heap = resident(), tab.run("performance.memory.usedJSHeapSize")
        simulated = tab.run("curvebound.time")
        time.sleep(5.0)
        assert tab.run("curvebound.time") > simulated
        assert resident() - held < 8e6
        assert tab.run("performance.memory.usedJSHeapSize") - heap < 30e6
        assert tab.errors == []
