"""Checking a target in processes of its own."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from .finding import FAILED, PASSED, Finding, Report
from .request import Request

__all__ = ["TIMEOUT", "check"]

#: s that one target may take
TIMEOUT = 600.0


def check(
    target: str,
    kind: str,
    request: Request,
    *,
    timeout: float = TIMEOUT,
    tell: Callable[[str], None] = lambda name: None,
) -> Report:
    """Check one target. kind: FMU (target is its file) or scene (a name or a file).

    tell: told the name of each check that begins, where that can be seen.
    """
    report = Report(target, kind)
    entries, ending = _worked(target, kind, request, timeout, digest_only=False)
    report.findings += [Finding(**entry["finding"]) for entry in entries if "finding" in entry]
    if ending:
        report.findings.append(Finding(_last_begun(entries), FAILED, ending))
    digest = next((entry["digest"] for entry in entries if "digest" in entry), None)
    if digest is not None:
        tell("process")
        report.findings.append(_in_another(target, kind, request, timeout, digest))
    return report


def _in_another(
    target: str, kind: str, request: Request, timeout: float, digest: dict[str, str]
) -> Finding:
    entries, ending = _worked(target, kind, request, timeout, digest_only=True)
    failure = ending or next((e["failure"] for e in entries if "failure" in e), "")
    if failure:
        return Finding("process", FAILED, f"in a second process: {failure}")
    other = next(entry["digest"] for entry in entries if "digest" in entry)
    different = [name for name in digest if other.get(name) != digest[name]]
    if different:
        return Finding("process", FAILED, f"{', '.join(different[:3])}: other bits in each process")
    return Finding("process", PASSED, "another process gives the same bits")


def _worked(
    target: str, kind: str, request: Request, timeout: float, *, digest_only: bool
) -> tuple[list[dict[str, Any]], str]:
    """The entries that a worker wrote, and how it ended if not well."""
    with tempfile.TemporaryDirectory(prefix="curvebound-check-") as folder:
        out = Path(folder) / "found.jsonl"
        asked = {
            "target": target,
            "kind": kind,
            "request": asdict(request),
            "digest_only": digest_only,
            "into": str(out),
        }
        file = Path(folder) / "request.json"
        file.write_text(json.dumps(asked, default=str), encoding="utf-8")
        command = [sys.executable, "-m", "curvebound.checking.worker", str(file)]
        ending = ""
        try:
            done = subprocess.run(command, capture_output=True, timeout=timeout)
            if done.returncode != 0:
                ending = _ended(done.returncode, done.stderr.decode(errors="replace"))
        except subprocess.TimeoutExpired:
            ending = f"it had not ended after {timeout:g} s (--timeout)"
        text = out.read_text(encoding="utf-8") if out.is_file() else ""
    return [json.loads(line) for line in text.splitlines()], ending


def _ended(status: int, said: str) -> str:
    if status < 0:
        try:
            name = signal.Signals(-status).name
        except ValueError:
            name = f"signal {-status}"
        return f"it ends the process with {name}"
    last = said.strip().splitlines()[-1:] or [""]
    return f"it ends the process with status {status}: {last[0]}"


def _last_begun(entries: list[dict[str, Any]]) -> str:
    """The check in which a process ended; `end` where all were done."""
    begun = [entry["begin"] for entry in entries if "begin" in entry]
    return (begun[-1] if begun else "description") or "end"
