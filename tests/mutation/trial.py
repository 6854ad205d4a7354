"""Trying a mutant: in a fork of a process that has collected all tests, or in a fresh process.

In the fork, which costs nothing but its tests, the functions that differ are given their new code.
What cannot be put in so (a constant of a module, an argument's default, a table made at import)
takes a fresh process. Either way the file itself is mutated: FMUs and processes that tests start
read it.
"""

from __future__ import annotations

import contextlib
import gc
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType
from typing import NoReturn

import pytest
from contexts import DERIVING, Contexts
from mutants import Mutant

__all__ = ["HUNG", "INVALID", "KILLED", "SURVIVED", "UNSEEN", "Trial"]

SURVIVED, KILLED, HUNG, UNSEEN, INVALID = "survived", "killed", "hung", "no test", "invalid"

#: what FMUs are built from: its mutants run interpreted, in FMUs of their own
BUILT = ("src/curvebound/kernel/", "src/curvebound/fmi/", "src/curvebound/mechanics/", "fmus/")
#: s of tests that are tried together, before those of which not each is needed
FIRST = (4.0, 20.0)


class Trial:
    """Tries mutants in the work tree `copy`."""

    def __init__(self, copy: Path, contexts: Contexts, budget: float) -> None:
        self.copy = copy
        self.contexts = contexts
        self.budget = budget
        self.items: dict[str, pytest.Item] = {}
        #: the three FMUs as tests/conftest.py shares them
        self.fmus = copy.parent
        #: tests that fail here without a mutant, and those that are known to pass
        self.unfit: set[str] = set()
        self.fit: set[str] = set()

    def verdict(self, mutant: Mutant) -> tuple[str, str]:
        """What becomes of a mutant, and the test that noticed."""
        path = self.copy / mutant.file
        text = path.read_text(encoding="utf-8")
        times = path.stat()
        tests = [t for t in self.contexts.seen_by(mutant.file, mutant.line, text)
                 if t in self.items]  # fmt: skip
        new = mutant.applied(text)
        codes = _changed(path, text, new) if path.suffix == ".py" else {}
        if mutant.file.startswith(DERIVING) or self.contexts.at_import(
            mutant.file, mutant.line, text
        ):
            codes = None
        path.write_text(new, encoding="utf-8")
        try:
            if path.suffix == ".c" and not self._compiles(path):
                return INVALID, ""
            return self._tried(mutant, tests, codes, (path, text, new, times))
        finally:
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    def _tried(self, mutant, tests, codes, source) -> tuple[str, str]:
        path, text, new, times = source
        while True:
            tests = [test for test in tests if test not in self.unfit]
            if not tests:
                return UNSEEN, ""
            for part in self._parts(tests):
                verdict, test = self._run(part, mutant, codes)
                if verdict != SURVIVED:
                    break
            if verdict == SURVIVED or test in self.fit or not test:
                return verdict, test
            # does it fail without the mutant, too?
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
            passes = self._run([test], mutant, {} if codes is not None else None)[0] == SURVIVED
            (self.fit if passes else self.unfit).add(test)
            if passes:
                return verdict, test
            path.write_text(new, encoding="utf-8")

    def _parts(self, tests: list[str]) -> Iterator[list[str]]:
        """The tests that take `budget` s together, in parts, each ordered by file."""
        limits = [x for x in FIRST if x < self.budget] + [self.budget]
        part: list[str] = []
        spent = 0.0
        for test in tests:
            spent += self.contexts.seconds[test] + 0.02
            if spent > limits[0] and part:
                yield sorted(part, key=lambda t: t.partition("::")[0])
                part = []
                while limits and spent > limits[0]:
                    limits.pop(0)
                if not limits:
                    return
            part.append(test)
        yield sorted(part, key=lambda t: t.partition("::")[0])

    def _compiles(self, path: Path) -> bool:
        python = sysconfig.get_path("include")
        command = ["cc", "-fsyntax-only", "-w", f"-I{self.copy}/tests/host", f"-I{python}",
                   str(path)]  # fmt: skip
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    def _run(self, tests: list[str], mutant: Mutant, codes: dict[CodeType, CodeType] | None):
        limit = 60.0 + 5.0 * sum(self.contexts.seconds[t] for t in tests)
        built = mutant.file.startswith(BUILT)
        # a kernel need not be compiled for a run of seconds; a binary calls what is compiled
        plain = built and mutant.file.endswith(".py")
        scratch = Path(tempfile.mkdtemp(prefix="curvebound-trial-"))
        log = scratch / "log.txt"
        try:
            child = os.fork()
            if child == 0:
                self._child(tests, codes, built, plain, scratch, log)
            status = _waited(child, limit)
            said = log.read_text(encoding="utf-8", errors="replace") if log.is_file() else ""
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
        failed = [line.partition(" ")[2].partition(" - ")[0] for line in said.splitlines()
                  if line.startswith(("FAILED tests/", "ERROR tests/"))]  # fmt: skip
        if status is None or "Failed: Timeout" in said:
            return HUNG, ""
        if status == 0:
            return SURVIVED, ""
        if not failed:
            print(said[-1500:], flush=True)
        return KILLED, failed[0] if failed and failed[0] in self.items else ""

    def _child(self, tests, codes, built, plain, scratch, log) -> NoReturn:
        status = 1
        try:
            os.setsid()
            target = os.open(log, os.O_WRONLY | os.O_CREAT)
            os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
            os.dup2(target, 1)
            os.dup2(target, 2)
            if codes is None:
                listed = scratch / "tests.txt"
                listed.write_text("".join(f"{t}\n" for t in tests), encoding="utf-8")
                plugin = ["-p", "interpreting"] if plain else []
                command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-p",
                           "no:cacheprovider", "-p", "no:xdist", *plugin, "-m", "",
                           "--timeout=60", f"--basetemp={scratch / 'base'}",
                           f"@{listed}"]  # fmt: skip
                os.execv(sys.executable, command)
            status = self._test(tests, codes, built, plain, scratch)
            sys.stdout.flush()
        except BaseException:
            import traceback

            traceback.print_exc()
            sys.stderr.flush()
        finally:
            os._exit(status)

    def _test(self, tests, codes, built, plain, scratch: Path) -> int:
        if plain:
            from interpreting import interpret

            interpret()
        _put(codes)
        items = [self.items[test] for test in tests]
        session = items[0].session
        base = scratch / "base"
        base.mkdir()
        session.config._tmp_path_factory._basetemp = base
        if not built:  # as they are: the mutant is no part of them
            for name in ("fmus", "interpreted"):
                (base / name).symlink_to(self.fmus / name)
        try:
            for item, after in zip(items, [*items[1:], None], strict=True):
                reports = _reports(item, after)
                for report in reports:
                    if report.failed:
                        print(f"\n{report.longreprtext}\nFAILED {item.nodeid}", flush=True)
                        return 1
        finally:
            with contextlib.suppress(BaseException):
                session._setupstate.teardown_exact(None)
        return 0


def _reports(item: pytest.Item, after: pytest.Item | None) -> list[pytest.TestReport]:
    from _pytest.runner import runtestprotocol

    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    return runtestprotocol(item, nextitem=after, log=False)


def _changed(path: Path, old: str, new: str) -> dict[CodeType, CodeType] | None:
    """Code of the functions that differ, old -> new; None: what is no function's differs."""
    try:
        before, after = (compile(text, str(path), "exec") for text in (old, new))
    except SyntaxError:
        return None
    found: dict[CodeType, CodeType] = {}
    return found if _compare(before, after, found) else None


def _compare(old: CodeType, new: CodeType, found: dict[CodeType, CodeType]) -> bool:
    if old.co_flags & 1:  # a function
        if old != new:
            found[old] = new
        return True
    parts = [[c for c in code.co_consts if isinstance(c, CodeType)] for code in (old, new)]
    plain = [[repr(c) for c in code.co_consts if not isinstance(c, CodeType)]
             for code in (old, new)]  # fmt: skip
    same = old.co_code == new.co_code and plain[0] == plain[1] and old.co_names == new.co_names
    return same and len(parts[0]) == len(parts[1]) and all(
        _compare(a, b, found) for a, b in zip(*parts, strict=True)
    )  # fmt: skip


def _put(codes: dict[CodeType, CodeType]) -> None:
    """Give all functions with old code their new code."""
    if codes:
        gc.unfreeze()  # tests/conftest.py hides what was there when tests were collected
        for thing in gc.get_objects():
            if isinstance(thing, FunctionType) and thing.__code__ in codes:
                thing.__code__ = codes[thing.__code__]


def _waited(child: int, limit: float) -> int | None:
    """The exit status of a child, which is ended, with what it started, after `limit` s: None."""
    end = time.monotonic() + limit
    found = 0
    while not found and time.monotonic() < end:
        time.sleep(0.02)
        found, status = os.waitpid(child, os.WNOHANG)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if not found:
        os.waitpid(child, 0)
        return None
    return os.waitstatus_to_exitcode(status)
