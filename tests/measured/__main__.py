"""Measure the figures that the READMEs state, and write them there.

    python tests/measured [GROUP ...]

Without a group those that do not depend on speed and take minutes only. The figures are kept in
figures.json beside this file, with machine and date; a test fails where one that does not depend on
speed has changed.
"""

from __future__ import annotations

import argparse
import datetime
import json
import platform
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from measured.groups import GROUPS, demo
from measured.random_points import COUNT
from measured.text import DOCUMENTS, put

from curvebound.files import write_whole
from curvebound.machine import machine

FIGURES = Path(__file__).with_name("figures.json")
COUNTED = ("points", "motions")
STEADY = ("demo", "errors", "models")


def figures(name: str, count: int) -> dict[str, Any]:
    """Of a group; count: runs, where it is one of many."""
    if name == "demo":
        return demo(draw=True)
    return GROUPS[name](count) if name in COUNTED else GROUPS[name]()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "group", nargs="*", choices=[*GROUPS, []], metavar="GROUP", help=", ".join(GROUPS)
    )
    parser.add_argument(
        "--count", type=int, default=COUNT,
        help=f"runs of each sample of points and motions (default: {COUNT}, a quarter of an hour)",
    )  # fmt: skip
    chosen = parser.parse_args()
    names = chosen.group or STEADY
    here = machine()
    where = f"{here['cores']} x {here['processor']}, Python {platform.python_version()}"
    measured = {}
    for name in names:
        print(f"measuring {name}", flush=True)
        measured[name] = {
            "date": datetime.date.today().isoformat(),
            "machine": where,
            "figures": figures(name, chosen.count),
        }
    # read late: another group may have been measured meanwhile
    entries = json.loads(FIGURES.read_text(encoding="utf-8")) if FIGURES.is_file() else {}
    entries |= measured
    text = json.dumps(entries, indent=1, sort_keys=True) + "\n"
    write_whole(FIGURES, lambda path: path.write_text(text, encoding="utf-8"))
    for document in DOCUMENTS:
        written = put(document.read_text(encoding="utf-8"), entries)
        write_whole(document, lambda path, written=written: path.write_text(written, "utf-8"))


if __name__ == "__main__":
    main()
