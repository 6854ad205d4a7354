"""What `curvebound stability` may be asked for: everything is refused before the first run."""

from __future__ import annotations

import argparse
from typing import Any

#: of options that are refused where they would not be heeded
_DEFAULTS = {
    "accuracy": 1e-3,
    "seed": 1,
    "tolerance": 1e-8,
    "times": 10.0,
}


def refuse(options: argparse.Namespace) -> None:
    """Wrong usage that the parser does not see."""
    maps = bool(options.scene or options.vary)
    if not (maps or options.all or options.sample is not None):
        options.wrong("give SCENE with --vary, or --all or --sample N")
    if maps and not (options.scene and options.vary):
        options.wrong("a map needs both SCENE and --vary component.variable=LOW:HIGH:N")
    _refuse_unheeded(options, maps)
    for name, default in _DEFAULTS.items():
        if getattr(options, name) is None:
            setattr(options, name, default)
    if options.documentation and (not options.all or options.method or options.no_plots):
        options.wrong("--documentation goes with --all and every method")
    if options.sample is not None and len(options.method or ()) > 1:
        options.wrong("--sample takes one --method")


def _refuse_unheeded(options: argparse.Namespace, maps: bool) -> None:
    """Options of what was not asked for."""
    groups = [
        (maps, "a map of SCENE with --vary", ("set", "steps", "stop")),
        (maps or options.all, "maps", ("accuracy",)),
        (options.sample is not None, "--sample", ("system", "seed", "tolerance", "times")),
    ]
    for asked, owner, names in groups:
        for name in names:
            if not asked and getattr(options, name) not in (None, []):
                options.wrong(f"--{name} belongs to {owner}")


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
