"""Sections printed as tables within 80 columns, and saved as JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from curvebound.files import write_whole

from .results import Cell, Section, Table, Target

__all__ = ["as_data", "print_report", "save"]

WIDTH = 80


def _shown(cell: Cell) -> str:
    """Three digits, and powers of ten only where digits would not do."""
    if cell is None:
        return "-"
    if isinstance(cell, float):
        if cell and not 1e-3 <= abs(cell) < 1e5:
            return f"{cell:.1e}"
        return f"{cell:.0f}" if abs(cell) >= 1000 else f"{cell:.3g}"
    return str(cell)


def _grid(console: Console, title: str) -> RichTable:
    """An empty table below its title, which may be wider than the table."""
    if title:
        console.print(Text(f"\n{title}", "bold"))
    return RichTable(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))


def _print_table(console: Console, table: Table) -> None:
    shown = _grid(console, table.title)
    for name, first in zip(table.columns, table.rows[0] if table.rows else (), strict=False):
        is_text = isinstance(first, str)
        shown.add_column(name, justify="left" if is_text else "right", no_wrap=is_text)
    for row in table.rows:
        shown.add_row(*map(_shown, row))
    console.print(shown)


def _print_targets(console: Console, targets: list[Target]) -> None:
    shown = _grid(console, "Targets")
    shown.add_column("what")
    for name in ("target", "measured", "met"):
        shown.add_column(name, justify="right")
    words = {True: Text("yes", "green"), False: Text("no", "bold red"), None: Text("-")}
    for target in targets:
        bound = f"{'>=' if target.at_least else '<='} {target.limit:g}"
        shown.add_row(target.name, bound, _shown(target.measured), words[target.met])
    console.print(shown)


def print_report(
    sections: list[Section], machine: dict[str, str], rounds: int, *, every_point: bool = False
) -> None:
    """Print all tables, the targets, and the machine below them."""
    terminal = Console()
    console = Console(width=min(WIDTH, terminal.width) if terminal.is_terminal else WIDTH)
    for section in sections:
        console.print()
        console.rule(section.title, align="left")
        for table in section.tables:
            if table.title != "every point" or every_point:
                _print_table(console, table)
        for note in section.notes:
            console.print(Text(note, "dim"))
    targets = [target for section in sections for target in section.targets]
    console.print()
    if targets:
        _print_targets(console, targets)
    footer = ", ".join(f"{name} {value}" for name, value in machine.items())
    console.print(
        Text(f"Medians of {rounds} interleaved rounds of CPU time. {footer}", "dim"), width=WIDTH
    )


def as_data(sections: list[Section], machine: dict[str, str], rounds: int) -> dict[str, Any]:
    """Everything as plain data; absent cells are None."""
    return {
        "machine": machine,
        "rounds": rounds,
        "sections": {
            section.name: {
                "title": section.title,
                "tables": [{"title": t.title, "rows": t.records()} for t in section.tables],
                "notes": section.notes,
            }
            for section in sections
        },
        "targets": [
            {
                "section": section.name,
                "name": target.name,
                "limit": target.limit,
                "at_least": target.at_least,
                "measured": target.measured,
                "met": target.met,
            }
            for section in sections
            for target in section.targets
        ],
    }


def save(data: dict[str, Any], path: Path) -> None:
    """Write `data` as JSON, whole or not at all."""
    text = json.dumps(data, indent=1) + "\n"
    write_whole(path, lambda half: half.write_text(text, encoding="utf-8"))
