"""What `curvebound stability` may be asked for: everything is refused before the first run."""

from __future__ import annotations

import argparse
import math
from typing import Any

#: methods that the long runs have, and the most periods or calls of one
LONG = ("semi_implicit_euler", "rk4", "implicit", "adaptive", "explicit_euler")
LONGEST = 1e9


def refuse(options: argparse.Namespace) -> None:
    """Wrong usage that the parser does not see."""
    maps = bool(options.scene or options.vary)
    if not (maps or options.all or options.long or options.sample is not None):
        options.wrong("give SCENE with --vary, or --all, --sample N or --long")
    if maps and not (options.scene and options.vary):
        options.wrong("a map needs both SCENE and --vary component.variable=LOW:HIGH:N")
    if options.jobs < 1 or (options.sample is not None and options.sample < 1):
        options.wrong("--sample and --jobs take numbers from 1 on")
    if not (0.0 < options.accuracy < math.inf):
        options.wrong("--accuracy must be above 0 and finite")
    if not (1000.0 <= options.periods <= LONGEST and 1000.0 <= options.calls <= LONGEST):
        options.wrong(f"--periods and --calls must be at least 1000 and at most {LONGEST:g}")
    for method in (options.long and options.method) or ():
        if method not in LONG:
            options.wrong(f"--long has no run of {method}, but of {', '.join(LONG)}")
    if options.documentation and (not options.all or options.method or options.no_plots):
        options.wrong("--documentation goes with --all and every method")
    if not maps and (options.set or options.steps or options.stop is not None):
        options.wrong("--set, --steps and --stop belong to a map of SCENE with --vary")
    if options.stop is not None and not 0.0 < options.stop < math.inf:
        options.wrong("--stop must be above 0 and finite")
    if options.sample is not None and len(options.method or ()) > 1:
        options.wrong("--sample takes one --method")
    if not (0.0 < options.tolerance < math.inf and 0.0 < options.times < math.inf):
        options.wrong("--tolerance and --times must be above 0 and finite")


def requests_of(options: argparse.Namespace) -> list[Any]:
    """The maps of --vary; ends with the usage where the words are wrong."""
    from ..errors import CurveboundError
    from ..study.stability.maps import Request, refuse_ignored, steps_from, values_of
    from ..study.stability.stability_map import METHODS

    requests = []
    try:
        for text in options.vary:
            requests.append(
                Request(
                    options.scene,
                    text,
                    tuple(options.set),
                    tuple(options.method or METHODS),
                    options.accuracy,
                    options.stop,
                    steps_from(options.steps),
                )
            )
            values_of(requests[-1])
            refuse_ignored(requests[-1])
    except CurveboundError as error:
        options.wrong(str(error))
    return requests
