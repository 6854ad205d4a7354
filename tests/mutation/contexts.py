"""Which tests can see a line: collected once by running the tests under coverage, then kept.

Only tests that are new since the last time are run, slow ones where that is wished. Where a source
has changed since, the tests that ran any of it are taken.
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
from pathlib import Path

from coverage import CoverageData
from coverage.exceptions import CoverageException
from watching import LONGEST, SETTINGS

__all__ = ["Contexts", "environment_of"]

HERE = Path(__file__).resolve().parent
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
        self.hashes: dict[str, str] = {}
        folder.mkdir(parents=True, exist_ok=True)
        self._data: dict[str, dict[int, set[str]]] = {}

    def collect(self, paths: list[str], *, slow: bool) -> None:
        """Run the tests in `paths` that are not known yet; forget those that are gone from there.

        slow: those marked so as well, each up to the limit of watching.py. What is known stays
        known where it is marked so later. Raises CalledProcessError where the tests cannot be
        collected.
        """
        notes = self.folder / "tests.json"
        kept = json.loads(notes.read_text(encoding="utf-8")) if notes.is_file() else {}
        there = self._there(paths, "") if paths else []
        wished = there if slow or not paths else self._there(paths, "not slow")
        known = {*kept.get("seconds", {}), *kept.get("left", {})}
        new = [test for test in wished if test not in known]
        if new:
            print(f"{len(new)} of {len(there)} tests are not known yet: running them", flush=True)
            found = self._run(new)
            shared = found.pop("shared")
            for key, value in found.items():
                kept.setdefault(key, {}).update(value)
            for fixture, tests in shared.items():
                kept.setdefault("shared", {}).setdefault(fixture, []).extend(tests)
            kept["hashes"] = {**self._hashes(), **kept.get("hashes", {})}
            notes.write_text(json.dumps(kept), encoding="utf-8")
        inside = tuple(paths)
        here = {t for t in kept["seconds"] if not (inside and t.startswith(inside))} | set(there)
        self.seconds = {t: s for t, s in kept["seconds"].items() if t in here}
        self.browser = {t for t in kept["browser"] if t in here}
        self.hashes = kept["hashes"]
        self._read(kept["shared"])

    def _there(self, paths: list[str], marks: str) -> list[str]:
        command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider",
                   "-m", marks, *paths]  # fmt: skip
        done = subprocess.run(
            command, cwd=self.copy, env=self.environment, capture_output=True, text=True, check=True
        )
        return [line for line in done.stdout.splitlines() if "::" in line]

    def _run(self, tests: list[str]) -> dict[str, dict[str, object]]:
        settings = self.folder / "coverage.cfg"
        data = self.folder / "coverage"
        settings.write_text(SETTINGS.format(tree=self.copy, data=data), encoding="utf-8")
        listed = self.folder / "new.txt"
        listed.write_text("".join(f"{test}\n" for test in tests), encoding="utf-8")
        watched = self.folder / "watched.json"
        command = [sys.executable, "-m", "coverage", "run", f"--rcfile={settings}", "-m", "pytest",
                   "-q", "-p", "watching", "-p", "interpreting", "-p", "no:cacheprovider",
                   "-p", "no:xdist", "-m", "",
                   "-o", f"timeout={LONGEST}", f"@{listed}"]  # fmt: skip
        environment = {**self.environment, "CAMPAIGN_WATCH": str(watched), "CAMPAIGN_TEST": ""}
        with (self.folder / "log.txt").open("w") as log:
            subprocess.run(
                command, cwd=self.copy, env=environment, stdout=log, stderr=log, check=False
            )
        for part in self.folder.glob("coverage.*.*"):
            held = CoverageData(basename=str(part))
            try:
                held.read()
                CoverageData(no_disk=True).update(held)
            except CoverageException:  # cut short by a test of full disks
                part.unlink()
        combine = [sys.executable, "-m", "coverage", "combine", f"--rcfile={settings}", "--append"]
        subprocess.run(
            combine, cwd=self.copy, env=self.environment, check=True, capture_output=True
        )
        found: dict[str, dict[str, object]] = json.loads(watched.read_text(encoding="utf-8"))
        return found

    def _hashes(self) -> dict[str, str]:
        return {
            path.relative_to(self.copy).as_posix(): _hash(path)
            for top in ("fmus", "src")
            for path in sorted((self.copy / top).rglob("*.py"))
        }

    def _read(self, shared: dict[str, list[str]]) -> None:
        data = CoverageData(basename=str(self.folder / "coverage"))
        data.read()
        for file in data.measured_files():
            lines = self._data.setdefault(_place(file), {})
            for line, contexts in data.contexts_by_lineno(file).items():
                seen = lines.setdefault(line, set())
                for context in contexts:
                    seen.update(shared.get(context, (context,)))

    def seen_by(self, file: str, line: int, text: str) -> list[str]:
        """Tests that run the line of `file`, whose content is `text`.

        The quickest case of each test function first, then the second of each, and so on.
        """
        if file.endswith(".js"):
            return self._sorted(self.browser)
        if file.endswith((".c", ".h")):
            return self._sorted(t for t in self.seconds if t.startswith("tests/host/"))
        seen = self._at(file, line, text)
        if seen <= {""}:  # run at import, or the numbers are other lines' now
            seen = {test for some in self._data.get(file, {}).values() for test in some}
        return self._sorted(seen)

    def at_import(self, file: str, line: int, text: str) -> bool:
        """Whether the line is run when modules are imported, and by no test."""
        return self._at(file, line, text) == {""}

    def _at(self, file: str, line: int, text: str) -> set[str]:
        lines = self._data.get(file, {})
        if self.hashes.get(file) != hashlib.sha256(text.encode()).hexdigest():
            return set()
        return {test for number in _statement(text, line) for test in lines.get(number, ())}

    def _sorted(self, tests: Iterable[str]) -> list[str]:
        place: dict[str, int] = {}
        cases: Counter[str] = Counter()
        for test in sorted((t for t in tests if t in self.seconds), key=self.seconds.__getitem__):
            function = test.partition("[")[0]
            place[test] = cases[function]
            cases[function] += 1
        return sorted(place, key=lambda t: (place[t], self.seconds[t]))


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


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


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
