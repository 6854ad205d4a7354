"""Which tests can see a line: collected once by running the tests under coverage, then kept.

Only tests that are new since the last time are run, slow ones where that is wished. What they ran
is kept with the sources as they were, and lines are found again in those that have changed since.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from difflib import SequenceMatcher
from pathlib import Path
from typing import Any

from coverage import CoverageData
from coverage.exceptions import CoverageException
from watching import LONGEST, SETTINGS

__all__ = ["DERIVING", "Contexts", "environment_of"]

HERE = Path(__file__).resolve().parent
#: sources whose results are kept, in the cache and in processes
DERIVING = "src/curvebound/mechanics/"
BATCH = 50  # tests that one process runs, and the rest of the last one's file
#: where a source is found when it runs -> where it stands; an FMU carries copies, line by line
PLACES = (
    (re.compile(r".*/src/curvebound/"), "src/curvebound/"),
    (re.compile(r".*/curvebound_[0-9a-f]{12}/"), "src/curvebound/"),
    (re.compile(r".*/fmus/(?=\w+/\w+\.py$)"), "fmus/"),
    (re.compile(r".*/(?=\w+_system_\w+/\w+\.py$)"), "fmus/"),
)


def environment_of(copy: Path, cache: Path) -> dict[str, str]:
    """Environment in which processes take the sources of `copy` and keep what they build apart."""
    path = os.pathsep.join((str(copy / "src"), str(HERE)))
    return {
        **os.environ, "PYTHONPATH": path, "CURVEBOUND_CACHE": str(cache),
        "PYTHONDONTWRITEBYTECODE": "1",
        "CAMPAIGN_REFERENCES": str(copy.parent / "references"),
    }  # fmt: skip


class Contexts:
    """What the tests in `copy` run, kept in `folder`."""

    def __init__(self, folder: Path, copy: Path, cache: Path) -> None:
        self.folder = folder
        self.copy = copy
        self.environment = environment_of(copy, cache)
        #: s that a test took, for all tests that pass
        self.seconds: dict[str, float] = {}
        #: tests in a browser
        self.browser: set[str] = set()
        folder.mkdir(parents=True, exist_ok=True)
        #: for all states of the sources under which tests were run: file -> text of it, and
        #: file -> line -> tests
        self._kept: list[tuple[dict[str, str], dict[str, dict[int, set[str]]]]] = []

    def collect(self, paths: list[str], *, slow: bool) -> None:
        """Run the tests in `paths` that are not known yet; forget those that are gone from there.

        slow: those marked so as well, each up to the limit of watching.py. What is known stays
        known where it is marked so later. Raises CalledProcessError where the tests cannot be
        collected.
        """
        notes = self.folder / "tests.json"
        kept: dict[str, Any] = {key: {} for key in ("seconds", "left", "shared", "browser")}
        if notes.is_file():
            kept = json.loads(notes.read_text(encoding="utf-8"))
        there = self._there(paths, "") if paths else []
        wished = there if slow or not paths else self._there(paths, "not slow")
        known = {*kept["seconds"], *kept["left"]}
        new = [test for test in wished if test not in known]
        if new:
            print(f"{len(new)} of {len(there)} tests are not known yet: running them", flush=True)
        for tests in _batches(new):
            self._keep(kept, tests)
            notes.write_text(json.dumps(kept), encoding="utf-8")
        inside = tuple(paths)
        here = {t for t in kept["seconds"] if not (inside and t.startswith(inside))} | set(there)
        self.seconds = {t: s for t, s in kept["seconds"].items() if t in here}
        self.browser = {t for t in kept["browser"] if t in here}
        for sources in sorted(self.folder.glob("*/sources.json")):
            self._read(sources, kept["shared"])

    def _there(self, paths: list[str], marks: str) -> list[str]:
        command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider",
                   "-m", marks, *paths]  # fmt: skip
        done = subprocess.run(
            command, cwd=self.copy, env=self.environment, capture_output=True, text=True, check=True
        )
        return [line for line in done.stdout.splitlines() if "::" in line]

    def _keep(self, kept: dict[str, Any], tests: list[str]) -> None:
        """Run some tests, and note in `kept` what they did.

        Those of a process that ended early stay unknown, and the next campaign runs them again.
        """
        files = ", ".join(dict.fromkeys(map(_file, tests)))
        found = self._run(tests)
        if not found:
            print(f"{files}: ended early, see {self.folder}/log.txt: not known", flush=True)
            return
        for fixture, users in found.pop("shared").items():
            kept["shared"].setdefault(fixture, []).extend(users)
        for key, value in found.items():
            kept[key].update(value)
        print(f"{files}: {len(found['seconds'])} of {len(tests)} passed", flush=True)

    def _run(self, tests: list[str]) -> dict[str, Any]:
        """What watching.py noted; nothing where pytest did not come to its end."""
        sources = self._sources()
        text = json.dumps(sources)
        folder = self.folder / hashlib.sha256(text.encode()).hexdigest()[:12]
        folder.mkdir(exist_ok=True)
        (folder / "sources.json").write_text(text, encoding="utf-8")
        settings = self.folder / "coverage.cfg"
        data = folder / "coverage"
        settings.write_text(SETTINGS.format(tree=self.copy, data=data), encoding="utf-8")
        listed = self.folder / "new.txt"
        listed.write_text("".join(f"{test}\n" for test in tests), encoding="utf-8")
        watched = self.folder / "watched.json"
        watched.unlink(missing_ok=True)
        command = [sys.executable, "-m", "coverage", "run", f"--rcfile={settings}", "-m", "pytest",
                   "-q", "-p", "watching", "-p", "interpreting", "-p", "no:cacheprovider",
                   "-p", "no:xdist", "-m", "",
                   "-o", f"timeout={LONGEST}", f"@{listed}"]  # fmt: skip
        environment = {**self.environment, "CAMPAIGN_WATCH": str(watched), "CAMPAIGN_TEST": ""}
        with (self.folder / "log.txt").open("w") as log:
            subprocess.run(
                command, cwd=self.copy, env=environment, stdout=log, stderr=log, check=False
            )
        for part in list(folder.glob("coverage.*.*")):
            held = CoverageData(basename=str(part))
            try:
                held.read()
                CoverageData(no_disk=True).update(held)
            except CoverageException:  # cut short by a test of full disks
                part.unlink()
        combine = [sys.executable, "-m", "coverage", "combine", f"--rcfile={settings}", "--append"]
        if any(folder.glob("coverage.*.*")):
            subprocess.run(
                combine, cwd=self.copy, env=self.environment, check=True, capture_output=True
            )
        found: dict[str, Any] = (
            json.loads(watched.read_text(encoding="utf-8")) if watched.is_file() else {}
        )
        return found

    def _sources(self) -> dict[str, str]:
        return {
            path.relative_to(self.copy).as_posix(): path.read_text(encoding="utf-8")
            for top in ("fmus", "src")
            for path in sorted((self.copy / top).rglob("*.py"))
        }

    def _read(self, sources: Path, shared: dict[str, list[str]]) -> None:
        data = CoverageData(basename=str(sources.with_name("coverage")))
        data.read()
        found: dict[str, dict[int, set[str]]] = {}
        for file in data.measured_files():
            lines = found.setdefault(_place(file), {})
            for line, contexts in data.contexts_by_lineno(file).items():
                seen = lines.setdefault(line, set())
                for context in contexts:
                    seen.update(shared.get(context, (context,)))
        self._kept.append((json.loads(sources.read_text(encoding="utf-8")), found))

    def seen_by(self, file: str, line: int, text: str) -> list[str]:
        """Tests that run the line of `file`, whose content is `text`.

        The quickest case of each test function first, then the second of each, and so on.
        """
        if file.endswith(".js"):
            return self._sorted(self.browser)
        if file.endswith((".c", ".h")):
            return self._sorted(t for t in self.seconds if t.startswith("tests/host/"))
        seen = self._at(file, line, text)
        if file.startswith(DERIVING):  # what it finds is kept: most tests run none of it
            seen |= {test for test in self.seconds if test.startswith("tests/mechanics/")}
        if seen <= {""}:  # run at import, or the line is new
            seen = {
                test for _, data in self._kept for some in data.get(file, {}).values()
                for test in some
            }  # fmt: skip
        return self._sorted(seen)

    def at_import(self, file: str, line: int, text: str) -> bool:
        """Whether the line is run when modules are imported, and by no test."""
        return self._at(file, line, text) == {""}

    def _at(self, file: str, line: int, text: str) -> set[str]:
        seen: set[str] = set()
        if not file.endswith(".py"):
            return seen
        for sources, data in self._kept:
            then = _lines_then(sources.get(file, ""), text)
            numbers = {then[number] for number in _statement(text, line) if number in then}
            seen.update(test for number in numbers for test in data.get(file, {}).get(number, ()))
        return seen

    def _sorted(self, tests: Iterable[str]) -> list[str]:
        place: dict[str, int] = {}
        cases: Counter[str] = Counter()
        for test in sorted((t for t in tests if t in self.seconds), key=self.seconds.__getitem__):
            function = test.partition("[")[0]
            place[test] = cases[function]
            cases[function] += 1
        return sorted(place, key=lambda t: (place[t], self.seconds[t]))


def _file(test: str) -> str:
    return test.partition("::")[0]


def _batches(tests: list[str]) -> list[list[str]]:
    """Whole files of tests, as many as one process shall run: what is known then is kept."""
    found: list[list[str]] = []
    for file in dict.fromkeys(map(_file, tests)):
        if not found or len(found[-1]) > BATCH:
            found.append([])
        found[-1] += [test for test in tests if _file(test) == file]
    return found


def _place(file: str) -> str:
    """Where a source that ran as `file` stands in the work tree."""
    for pattern, new in PLACES:
        place, found = pattern.subn(new, file)
        if found:
            break
    system = re.fullmatch(r"fmus/(\w+)_system_\w+/(\w+)\.py", place)
    if system is None:
        return place
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", system[1]).lower()
    return f"fmus/{name}/{'fmu' if system[2] == 'declaration' else system[2]}.py"


def _lines_then(then: str, now: str) -> dict[int, int]:
    """Numbers of the lines of a text -> those that the same lines had in an earlier one."""
    blocks = SequenceMatcher(None, then.splitlines(), now.splitlines(), autojunk=False)
    return {
        block.b + i + 1: block.a + i + 1
        for block in blocks.get_matching_blocks() for i in range(block.size)
    }  # fmt: skip


def _statement(text: str, line: int) -> range:
    """Lines of the innermost statement around a line, without the statements in it."""
    best = range(line, line + 1)
    size = sys.maxsize
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or line):
            body = getattr(node, "body", None)
            end = body[0].lineno if body else (node.end_lineno or line) + 1
            found = range(node.lineno, max(end, node.lineno + 1))
            if line in found and len(found) <= size:
                best, size = found, len(found)
    return best
