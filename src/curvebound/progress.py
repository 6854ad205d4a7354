"""How far long work is: a bar on a terminal; elsewhere, such as in CI, a line now and then."""

from __future__ import annotations

import logging
import sys
import threading
import time as clock
from typing import Any

__all__ = ["EVERY", "Progress", "duration"]

_LOG = logging.getLogger("curvebound.progress")

#: s between lines, and before the first
EVERY = 15.0
#: s before a bar appears
_SOON = 1.0


class Progress:
    """Use as a context manager, and call it with what is done.

    label: what is being done; total: how much there is to do, None where that is not known yet;
    unit: behind the numbers. A bar appears on standard error where that is a terminal, and nothing
    of it stays; elsewhere a line goes to the log every `EVERY` seconds, whether or not there is
    news, as a thread of its own writes it. Lines and bar are left out where the log's level is
    above INFO.
    """

    def __init__(self, label: str, total: float | None = None, unit: str = "") -> None:
        self._label, self._total, self._unit = label, total, unit
        self._done, self._note = 0.0, ""
        self._began = clock.monotonic()
        self._finished = threading.Event()
        self._bar: Any = None
        self._task: Any = None
        self._lines: threading.Thread | None = None

    def __enter__(self) -> Progress:
        self._shown = _LOG.isEnabledFor(logging.INFO)
        self._terminal = sys.stderr.isatty()
        if self._shown and not self._terminal:
            self._lines = threading.Thread(target=self._write, daemon=True)
            self._lines.start()
        return self

    def __exit__(self, *exception: object) -> None:
        self._finished.set()
        if self._lines is not None:
            self._lines.join()
        if self._bar is not None:
            self._bar.stop()

    def __call__(
        self,
        done: float | None = None,
        total: float | None = None,
        note: str = "",
        label: str | None = None,
    ) -> None:
        """Tell how much is done, and of how much, where they changed; note: what is being done."""
        self._done = self._done if done is None else done
        self._total = self._total if total is None else total
        self._label = self._label if label is None else label
        self._note = note
        if self._shown and self._terminal:
            self._draw()

    def line(self) -> str:
        """How far it is, in words."""
        spent = clock.monotonic() - self._began
        text = self._label
        if self._total is not None:
            text += f": {self._done:.4g} of {self._total:.4g}{self._unit and ' ' + self._unit}"
        if self._note:
            text += f" ({self._note})"
        text += f", after {duration(spent)}"
        if self._total is not None and 0.0 < self._done <= self._total:
            text += f", about {duration(spent * (self._total / self._done - 1.0))} left"
        return text

    def _write(self) -> None:
        while not self._finished.wait(EVERY):
            _LOG.info(self.line())

    def _draw(self) -> None:
        if self._bar is None:
            if clock.monotonic() < self._began + _SOON:
                return
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            self._bar = Bar(
                TextColumn("{task.description}"), BarColumn(bar_width=24),
                TextColumn("{task.fields[far]}"), TimeRemainingColumn(),
                TextColumn("{task.fields[note]}"), console=Console(stderr=True), transient=True,
            )  # fmt: skip
            self._bar.start()
            self._task = self._bar.add_task(self._label, total=self._total, far="", note="")
        far = "" if self._total is None else f"{self._done:.4g}/{self._total:.4g} {self._unit}"
        self._bar.update(
            self._task, completed=self._done, total=self._total, description=self._label, far=far,
            note=self._note,
        )  # fmt: skip


def duration(seconds: float) -> str:
    """A time as one says it: 40 s, 3 min 20 s, 2 h 5 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
