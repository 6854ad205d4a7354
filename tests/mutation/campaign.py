"""How many small faults the tests notice: a mutation campaign.

    python tests/mutation/campaign.py --room cosim --number 30 --seed 1
    python tests/mutation/campaign.py                       # every room, 20 mutants each

Draws single small faults (see mutants.py), puts one at a time into a copy of the work tree and runs
there the tests that can see it (see contexts.py), the quickest first, until one fails. Prints each
mutant that survived or hung, and a table. Slow, and no part of CI.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import os
import random
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NoReturn

import pytest
from contexts import Contexts, environment_of
from mutants import Mutant, mutants_of

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
    "view": (f"{SRC}/view/*.py",),
    "javascript": (f"{SRC}/view/assets/[!u]*.js",),
    "cli": (f"{SRC}/cli/*.py", f"{SRC}/*.py"),
}
#: what the tests and the sources import from elsewhere: done once, for all mutants
ELSEWHERE = ("fmpy.fmi2", "fmpy.simulation", "fmpy.ssp.simulation", "hypothesis", "lxml.etree",
             "matplotlib.figure", "mpmath", "numpy", "pythonfmu.builder", "rich.console",
             "rich.progress", "rich.table", "scipy.integrate", "scipy.optimize", "sympy",
             "websockets.sync.client")  # fmt: skip
SURVIVED, KILLED, HUNG, UNSEEN, INVALID = "survived", "killed", "hung", "no test", "invalid"


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


def within(tests: list[str], seconds: dict[str, float], budget: float) -> list[str]:
    """The first tests that take `budget` s together, one at least."""
    chosen: list[str] = []
    for test in tests:
        budget -= seconds[test] + 0.02
        if budget < 0.0 and chosen:
            break
        chosen.append(test)
    return chosen


class Trial:
    """Tries mutants in a copy of its own."""

    def __init__(self, copy: Path, cache: Path, contexts: Contexts, budget: float) -> None:
        self.copy = copy
        self.environment = environment_of(copy, cache)
        self.contexts = contexts
        self.budget = budget

    def verdict(self, mutant: Mutant) -> str:
        path = self.copy / mutant.file
        text = path.read_text(encoding="utf-8")
        direct, inside = self.contexts.seen_by(mutant.file, mutant.line, text)
        stages = [within(some, self.contexts.seconds, self.budget) for some in (direct, inside)]
        stages = [tests for tests in stages if tests]
        if not stages:
            return UNSEEN
        path.write_text(mutant.applied(text), encoding="utf-8")
        try:
            if path.suffix == ".c" and not self._compiles(path):
                return INVALID
            for tests in stages:
                found = self._run(tests)
                if found != SURVIVED:
                    return found
            return SURVIVED
        finally:
            path.write_text(text, encoding="utf-8")

    def _compiles(self, path: Path) -> bool:
        python = sysconfig.get_path("include")
        command = [
            "cc",
            "-fsyntax-only",
            "-w",
            f"-I{self.copy}/tests/host",
            f"-I{python}",
            str(path),
        ]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    def _run(self, tests: list[str]) -> str:
        """Run tests in a fork of this process, which has imported what they need from elsewhere."""
        listed = self.copy / "tests.txt"
        listed.write_text("".join(f"{test}\n" for test in tests), encoding="utf-8")
        arguments = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "interpreting",
                     "-m", "", "--timeout=120", f"@{listed}"]  # fmt: skip
        limit = 300.0 + 5.0 * sum(self.contexts.seconds[t] for t in tests)
        with tempfile.TemporaryFile() as log:
            child = os.fork()
            if child == 0:
                self._test(arguments, log.fileno())
            status = _waited(child, limit)
            log.seek(0)
            said = log.read().decode(errors="replace")
        if status is None or "Failed: Timeout" in said:
            return HUNG
        return SURVIVED if status in (0, 5) else KILLED

    def _test(self, arguments: list[str], log: int) -> NoReturn:
        """What the fork does; its exit status is pytest's."""
        status = 1
        try:
            os.setsid()
            os.dup2(log, 1)
            os.dup2(log, 2)
            os.chdir(self.copy)
            os.environ.update(self.environment)
            sys.path[:0] = self.environment["PYTHONPATH"].split(os.pathsep)
            sys.dont_write_bytecode = True
            status = int(pytest.main(arguments))
            sys.stdout.flush()
        finally:
            os._exit(status)


def _waited(child: int, limit: float) -> int | None:
    """The exit status of a child, which is ended, with what it started, after `limit` s: None."""
    end = time.monotonic() + limit
    found = 0
    while not found and time.monotonic() < end:
        time.sleep(0.05)
        found, status = os.waitpid(child, os.WNOHANG)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if not found:
        os.waitpid(child, 0)
        return None
    return os.waitstatus_to_exitcode(status)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("--room", action="append", choices=sorted(ROOMS), help="default: all")
    parser.add_argument("--number", type=int, default=20, help="mutants in each room (20)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--budget", type=float, default=60.0, metavar="SECONDS",
                        help="of tests that run a mutant at most, as they take unmutated (60); "
                        "twice for what runs in FMUs")  # fmt: skip
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


def campaign(chosen: argparse.Namespace, scratch: Path) -> None:
    """Collect contexts, try mutants, print what came of them."""
    copy = copy_of_the_work_tree(scratch / "tree")
    folder = chosen.contexts.resolve()
    cache = folder / "cache"
    contexts = Contexts(folder, copy, cache)
    contexts.collect(chosen.tests, slow=chosen.slow)
    trial = Trial(copy, cache, contexts, chosen.budget)
    for module in ELSEWHERE:
        with contextlib.suppress(ImportError):
            importlib.import_module(module)
    counts: dict[str, Counter[str]] = {}
    for room in chosen.room or ROOMS:
        count = counts[room] = Counter()
        for mutant in drawn(copy, room, chosen.number, chosen.seed):
            began = time.monotonic()
            verdict = trial.verdict(mutant)
            count[verdict] += 1
            print(f"{verdict:8} {time.monotonic() - began:4.0f} s  {mutant}", flush=True)
    verdicts = (KILLED, HUNG, SURVIVED, UNSEEN, INVALID)
    print(f"\nseed {chosen.seed}\n{'room':12}" + "".join(f"{v:>10}" for v in verdicts))
    for room, count in counts.items():
        print(f"{room:12}" + "".join(f"{count[v]:10}" for v in verdicts))


if __name__ == "__main__":
    main()
