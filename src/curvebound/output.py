"""Where the output of a command goes: tables and lines for people, or JSON for programs.

With --json standard output has one JSON document, and what is for people goes to standard error;
--quiet leaves that out, and progress as well. Errors are said in any case.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["aligned", "configure", "console_of", "hand_out", "logging_to_stderr", "say"]

_LEVELS = ("debug", "info", "warning", "error")


def configure(parser: argparse.ArgumentParser, *, json: bool) -> None:
    """Add the options that all commands share; json: whether the command has something to give."""
    group = parser.add_argument_group("output")
    if json:
        group.add_argument("--json", action="store_true", help="print JSON in place of tables")
    group.add_argument("--quiet", action="store_true", help="no tables, no progress: errors only")
    group.add_argument(
        "--log-level", choices=_LEVELS, default="info",
        help="least importance of what is logged; progress is info (default: info)",
    )  # fmt: skip


@contextmanager
def logging_to_stderr(options: argparse.Namespace) -> Iterator[None]:
    """In here the log goes to standard error, from the level on that the options ask for."""
    log, handler = logging.getLogger("curvebound"), _StandardError()
    before = log.level
    log.setLevel("ERROR" if options.quiet else options.log_level.upper())
    log.addHandler(handler)
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.setLevel(before)


class _StandardError(logging.Handler):
    """Writes to whatever standard error is at that moment."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr, flush=True)


def console_of(options: argparse.Namespace) -> Console:
    """Where a command prints what is for people."""
    from rich.console import Console

    as_json: bool = getattr(options, "json", False)
    return Console(highlight=False, stderr=as_json, quiet=options.quiet)


def say(options: argparse.Namespace, text: str) -> None:
    """Print a line or more for people, without rich, which takes its time to load."""
    if not options.quiet:
        print(text, file=sys.stderr if getattr(options, "json", False) else sys.stdout)


def aligned(rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Rows of words as lines with columns; the first `left` of them begin, the others end alike."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            word.ljust(width) if i < left else word.rjust(width)
            for i, (word, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def hand_out(options: argparse.Namespace, data: Any) -> None:
    """Print what is for programs, where it was asked for."""
    if options.json:
        import json

        print(json.dumps(data, indent=1, default=_plain))


def _plain(value: Any) -> Any:
    """numpy's numbers and arrays, and paths, as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return str(value)
