"""Live scenes in headless Chromium: pace, pictures a second, delay from slider to motion, memory.

On an otherwise idle machine: server and browser share what there is.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import NamedTuple

from rich.console import Console
from rich.table import Table

from curvebound.arguments import whole
from curvebound.cosim import load_scene, scene_names
from curvebound.errors import CurveboundError
from curvebound.view.live.plan import Plan

_VIEW = Path(__file__).resolve().parents[1] / "view"
sys.path += [str(_VIEW), str(_VIEW / "live")]

from browsing import Browser, Tab  # noqa: E402
from serving import served  # noqa: E402

from .worker import resident  # noqa: E402

__all__ = ["configure", "run"]

_CLOCKS = "[performance.now() / 1000, curvebound.time]"
_WINDOWS = 6
#: changes the force on a slider at rest and waits for the first picture in which it has moved
_PUSH = """new Promise((done) => {
  const began = performance.now();
  const slider = document.querySelector('[aria-label="plant.slider.fx"]');
  slider.value = 9;
  slider.dispatchEvent(new Event('input'));
  const look = () => (Math.abs(curvebound.placed[0].point('slider')[0]) > 1e-9
    ? done(performance.now() - began) : requestAnimationFrame(look));
  look();
})"""


class Aim(NamedTuple):
    """What is measured, in words, and whether a figure meets what was asked."""

    words: str
    met: Callable[[float], bool]


AIMS = (
    Aim("s simulated per s (1 within 2 %)", lambda found: abs(found - 1.0) <= 0.02),
    Aim("pictures per s (at least 50)", lambda found: found >= 50.0),
    Aim("server grew, MB (below 8)", lambda found: found < 8.0),
    Aim("page grew, MB (below 30)", lambda found: found < 30.0),
)
_LATENCY = 100.0  # ms


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", nargs="*", help="scenes to run (default: all)")
    parser.add_argument("--seconds", type=whole(6), default=60, help="s for each (default: 60)")


def run(options: argparse.Namespace) -> int:
    """Print the figures; 1 where one misses what was asked."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        raise CurveboundError("Chromium is missing: `bash .ci/browser` installs it.")
    table = Table("scene", *(aim.words for aim in AIMS), box=None)
    table.columns[0].no_wrap = True
    missed = False
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(program, Path(folder) / "profile")
        try:
            for name in options.scene or scene_names():
                found = _pace(_tab(browser), name, Path(folder), options.seconds)
                missed |= not all(aim.met(x) for aim, x in zip(AIMS, found, strict=True))
                table.add_row(name, *(f"{x:.3g}" for x in found))
            delay = _delay(_tab(browser), Path(folder))
        finally:
            browser.close()
    console = Console(highlight=False)
    console.print(table)
    console.print(f"from slider to motion: {delay:.0f} ms, median of 10 (below {_LATENCY:.0f})")
    return int(missed or delay >= _LATENCY)


def _tab(browser: Browser) -> Tab:
    tab = browser.tab()
    tab.size(1280, 900)
    return tab


def _pace(tab: Tab, name: str, folder: Path, seconds: int) -> tuple[float, ...]:
    """The figures of AIMS; pictures per s are the median of windows."""
    with served(Plan(load_scene(name)), folder) as serving:
        tab.visit(f"{serving.address}#play=1")
        tab.wait("curvebound.time > curvebound.model.start + 2")
        held, heap = resident(), tab.run("performance.memory.usedJSHeapSize")
        real, simulated = tab.run(_CLOCKS)
        pictures = []
        for _ in range(_WINDOWS):
            tab.run("curvebound.frameTimes.length = 0")
            time.sleep(seconds / _WINDOWS)
            pictures.append(tab.run("curvebound.framesPerSecond()"))
        until = tab.run(_CLOCKS)
        pace = (until[1] - simulated) / (until[0] - real)
        grown = (tab.run("performance.memory.usedJSHeapSize") - heap) / 1e6
        figures = pace, median(pictures), (resident() - held) / 1e6, grown
    tab.close()
    return figures


def _delay(tab: Tab, folder: Path) -> float:
    """Median of the ms from a slider's event to the first picture of a body at rest that moved."""
    with served(Plan(load_scene("pendulum_small")), folder) as serving:
        tab.visit(f"{serving.address}#play=0")
        tab.wait("curvebound.samples[0]?.length")
        rest = {"plant.slider.u_start": 0, "plant.pendulum.angle_start": 0}
        taken = []
        for _ in range(10):
            tab.run("curvebound.send({ do: 'set', path: 'plant.slider.fx', value: 0 })")
            tab.run(f"curvebound.send({{ do: 'restart', settings: {rest} }})")
            tab.run("curvebound.send({ do: 'play' })")
            tab.wait("curvebound.time < 0.3")  # the run before, pushed, was later than that
            tab.wait("curvebound.time > 0.3")
            taken.append(tab.run(_PUSH))
    tab.close()
    return median(taken)
