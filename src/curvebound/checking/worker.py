"""The process in which a target is checked, so that one that crashes or hangs is a finding too.

    python -m curvebound.checking.worker REQUEST.json

Whatever the FMU prints goes to its standard output; what is found is appended to the file that the
request names, one JSON object to a line: begin (a check's name), finding, digest.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..errors import CurveboundError
from .finding import Wrong
from .fmu import FmuCheck
from .request import Request
from .scene import SceneCheck

__all__ = ["main"]


def main(request: Path) -> None:
    """Do what the request asks for."""
    asked = json.loads(request.read_text(encoding="utf-8"))
    with Path(asked["into"]).open("a", encoding="utf-8", buffering=1) as out:

        def say(**entry: Any) -> None:
            out.write(json.dumps(entry) + "\n")

        check = _check(asked)
        if not asked["digest_only"]:
            for finding in check.findings(lambda name: say(begin=name)):
                say(finding=asdict(finding))
                if finding.check == "simulation" and finding.outcome == "passed":
                    say(digest=check.digest())
        else:
            say(begin="process")
            try:
                say(digest=check.digest())
            except (CurveboundError, Wrong) as error:
                say(failure=str(error))
        say(begin="")


def _check(asked: dict[str, Any]) -> FmuCheck | SceneCheck:
    options = dict(asked["request"])
    for name in ("reference", "inputs"):
        options[name] = options[name] and Path(options[name])
    if asked["kind"] == "FMU":
        return FmuCheck(Path(asked["target"]), Request(**options))
    return SceneCheck(asked["target"], Request(**options))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
