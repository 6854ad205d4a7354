"""Stability maps of both systems over all their ranges, and the pictures that the FMUs carry."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from curvebound.arguments import whole
from curvebound.files import inside
from curvebound.study.stability.map_report import nothing_known, write_index, write_map
from curvebound.study.stability.maps import make_maps

from .catalogue import catalogue
from .compact_picture import write_compact

__all__ = ["configure", "run"]


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("--jobs", type=whole(1), default=1, help="processes (default: 1)")
    parser.add_argument("--out", type=Path, default=Path("build/stability"), metavar="DIR")
    parser.add_argument(
        "--documentation", type=Path, metavar="DIR", help="write the FMUs' pictures here (fmus)"
    )


def run(options: argparse.Namespace) -> int:
    """Make all maps and what is written of them; 1 where nothing is known in one of them."""
    console = Console(highlight=False)
    requests = catalogue()
    pages = []
    found = []
    good = True
    with Progress(console=console) as bar:
        task = bar.add_task("maps", total=None)
        made = make_maps(
            requests,
            jobs=options.jobs,
            progress=lambda done, count, path: bar.update(
                task, completed=done, total=count, description=path
            ),
        )
        for request, maps in made:
            name = request.made().name
            page = write_map(request, maps, name, request.unit, inside(options.out, name))
            pages.append((f"{name}: {request.axis.path}", page))
            found.append((request, maps))
            why = nothing_known(maps)
            if why:
                good = False
                console.print(f"{page}: nothing is known at any value: {why}", soft_wrap=True)
    console.print(str(write_index(pages, options.out)), soft_wrap=True)
    for path in write_compact(found, options.documentation or options.out):
        console.print(str(path), soft_wrap=True)
    return int(not good)
