"""How many small faults the tests notice: a mutation campaign.

    python tests/mutation/campaign.py --room cosim --number 30 --seed 1
    python tests/mutation/campaign.py                       # every room, 20 mutants each

Draws single small faults (see mutants.py), puts one at a time into a copy of the work tree and
runs there the tests that run its line (see contexts.py), the quickest first, until one fails.
Prints what became of each mutant, and a table. Slow, and no part of CI.
"""

from __future__ import annotations

import argparse
import compileall
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest
from contexts import Contexts
from mutants import Mutant, mutants_of
from trial import HUNG, INVALID, KILLED, SURVIVED, UNSEEN, Trial

ROOT = Path(__file__).resolve().parents[2]
SRC = "src/curvebound"
#: room -> patterns of its files
ROOMS = {
    "systems": ("fmus/**/*.py",),
    "kernel": (f"{SRC}/kernel/*.py",),
    "compiling": (f"{SRC}/compiling/*.py",),
    "mechanics": (f"{SRC}/mechanics/**/*.py",),
    "fmi": (f"{SRC}/fmi/**/*.py",),
    "native": (f"{SRC}/fmi/**/*.c",),
    "cosim": (f"{SRC}/cosim/*.py",),
    "study": (f"{SRC}/study/**/*.py",),
    "view": (f"{SRC}/view/**/*.py", f"{SRC}/pages/*.py"),
    "javascript": (f"{SRC}/view/assets/[!u]*.js",),
    "cli": (f"{SRC}/cli/*.py", f"{SRC}/*.py"),
}


def copy_of_the_work_tree(folder: Path) -> Path:
    """What git knows or would add, as it is now."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout.decode()
    for name in filter(None, listed.split("\0")):
        if (ROOT / name).is_file():
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, target)
    return folder


def drawn(copy: Path, room: str, number: int, seed: int) -> list[Mutant]:
    """`number` mutants of a room, the same for the same sources and seed."""
    draw = random.Random(f"{room} {seed}")
    files = sorted({path for pattern in ROOMS[room] for path in copy.glob(pattern)})
    found: list[Mutant] = []
    for path in files:
        text = path.read_text(encoding="utf-8")
        found += mutants_of(path.relative_to(copy).as_posix(), text, draw)
    return draw.sample(found, min(number, len(found)))


class Campaign:
    """A pytest plugin: tries mutants where the tests that were collected would be run."""

    def __init__(self, chosen: argparse.Namespace, copy: Path, contexts: Contexts) -> None:
        self.chosen = chosen
        self.copy = copy
        self.trial = Trial(copy, contexts, chosen.budget)

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self.trial.items = {item.nodeid: item for item in session.items}
        for seed in self.chosen.seed or [1]:
            counts: dict[str, Counter[str]] = {}
            for room in self.chosen.room or ROOMS:
                counts[room] = Counter(
                    self._tried(mutant)
                    for mutant in drawn(self.copy, room, self.chosen.number, seed)
                    if any(words in str(mutant) for words in self.chosen.only or [""])
                )
            verdicts = (KILLED, HUNG, SURVIVED, UNSEEN, INVALID)
            columns = ("drawn", *verdicts, "noticed")
            print(f"\nseed {seed}\n{'room':12}" + "".join(f"{name:>10}" for name in columns))
            for room, count in counts.items():
                share = (count[KILLED] + count[HUNG]) / max(1, count.total() - count[INVALID])
                row = "".join(f"{n:10}" for n in (count.total(), *(count[v] for v in verdicts)))
                print(f"{room:12}{row}{share:10.0%}", flush=True)
        return True

    def _tried(self, mutant: Mutant) -> str:
        began = time.monotonic()
        verdict, test = self.trial.verdict(mutant)
        took = time.monotonic() - began
        print(f"{verdict:8} {took:4.0f} s  {mutant}   {test and 'by ' + test}", flush=True)
        return verdict


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--room", action="append", choices=sorted(ROOMS), help="default: all")
    parser.add_argument("--number", type=int, default=20, help="mutants in each room (20)")
    parser.add_argument("--seed", type=int, action="append", help="default: 1")
    parser.add_argument("--only", action="append", metavar="WORDS",
                        help="of those drawn, mutants that are printed with these, as "
                        "loops.py:109; may be repeated")  # fmt: skip
    parser.add_argument("--budget", type=float, default=60.0, metavar="SECONDS",
                        help="of tests for a mutant, as they take watched (60)")  # fmt: skip
    parser.add_argument("--contexts", type=Path, default=ROOT / "build" / "mutation",
                        help="where to keep what the tests run (build/mutation)")  # fmt: skip
    parser.add_argument("--tests", nargs="*", default=["tests"], metavar="PATH",
                        help="where to look for new tests (tests); none: nowhere")  # fmt: skip
    parser.add_argument("--slow", action="store_true", help="look for new slow tests, too")
    chosen = parser.parse_args()

    scratch = Path(tempfile.mkdtemp(prefix="curvebound-mutation-"))
    try:
        campaign(chosen, scratch)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def build_fmus(folder: Path) -> None:
    """Build the three FMUs as tests/conftest.py shares them, and what interpreting.py reads."""
    script = (
        "import sys; from pathlib import Path; from curvebound.fmi.build import build\n"
        "from curvebound.fmi.folder import names\n"
        "for name in names():\n"
        "    build(name, Path(sys.argv[1], 'fmus'), compiled=True)\n"
        "    build(name, Path(sys.argv[1], 'interpreted'), compiled=False)\n"
        "from interpreting import keep_references\n"
        "keep_references(Path(sys.argv[1], 'references'))\n"
    )
    subprocess.run([sys.executable, "-c", script, str(folder)], check=True)


def campaign(chosen: argparse.Namespace, scratch: Path) -> None:
    """Collect contexts and tests, try mutants, print what came of them."""
    copy = copy_of_the_work_tree(scratch / "tree")
    folder = chosen.contexts.resolve()
    contexts = Contexts(folder, copy, folder / "cache")
    os.environ.update(contexts.environment)
    build_fmus(scratch)
    contexts.collect(chosen.tests, slow=chosen.slow)
    os.chdir(copy)
    sys.path[:0] = contexts.environment["PYTHONPATH"].split(os.pathsep)
    compileall.compile_dir(copy, quiet=1)
    sys.dont_write_bytecode = True  # a mutant is as old as what it was made of, to a second
    arguments = ["-s", "-q", "--no-summary", "-p", "no:cacheprovider", "-p", "no:xdist", "-m", "",
                 "--timeout=60", "tests"]  # fmt: skip
    pytest.main(arguments, plugins=[Campaign(chosen, copy, contexts)])


if __name__ == "__main__":
    main()
