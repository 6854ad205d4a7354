"""Measure the figures that the READMEs state, and write them there.

    python tests/measured [GROUP ...]

Without a group those that do not depend on speed. The figures are kept in figures.json beside this
file, with machine and date; a test fails where one that does not depend on speed has changed.
"""

from __future__ import annotations

import argparse
import datetime
import json
import platform
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from measured.groups import GROUPS, demo
from measured.text import DOCUMENTS, put

from curvebound.files import write_whole
from curvebound.machine import machine

FIGURES = Path(__file__).with_name("figures.json")
STEADY = ("demo", "errors", "models")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("group", nargs="*", choices=[*GROUPS, []], help=", ".join(GROUPS))
    names = parser.parse_args().group or STEADY
    here = machine()
    where = f"{here['cores']} x {here['processor']}, Python {platform.python_version()}"
    entries = json.loads(FIGURES.read_text(encoding="utf-8")) if FIGURES.is_file() else {}
    for name in names:
        print(f"measuring {name}", flush=True)
        entries[name] = {
            "date": datetime.date.today().isoformat(),
            "machine": where,
            "figures": demo(draw=True) if name == "demo" else GROUPS[name](),
        }
    text = json.dumps(entries, indent=1, sort_keys=True) + "\n"
    write_whole(FIGURES, lambda path: path.write_text(text, encoding="utf-8"))
    for document in DOCUMENTS:
        written = put(document.read_text(encoding="utf-8"), entries)
        write_whole(document, lambda path, written=written: path.write_text(written, "utf-8"))


if __name__ == "__main__":
    main()
