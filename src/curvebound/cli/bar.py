"""The progress bar of commands that work long."""

from __future__ import annotations

from typing import Any


def progress_bar(console: Any) -> Any:
    """A bar with the number of pieces done and the time that remains; a task has a `note`.

    Nothing of it stays, and nothing is shown unless the console is a terminal.
    """
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    return Progress(
        TextColumn("{task.description}"), BarColumn(bar_width=24), MofNCompleteColumn(),
        TimeRemainingColumn(), TextColumn("{task.fields[note]}"),
        console=console, transient=True, disable=not console.is_terminal,
    )  # fmt: skip
