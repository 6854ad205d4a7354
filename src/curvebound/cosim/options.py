"""The options that change a scene on a command line, and the scenes that they ask for."""

from __future__ import annotations

import argparse
from typing import TypeVar

from ..arguments import file_of, seconds, setting
from .scene_data import SceneData
from .scene_parts import ALGORITHMS, HOLDS, Adaptive

#: endings of results' names, see curvebound.cosim.formats
FORMATS = (".csv", ".json", ".parquet", ".npz")

__all__ = ["FORMATS", "changed", "chosen", "configure", "configure_changes"]

AnyScene = TypeVar("AnyScene", bound=SceneData)


def configure_changes(parser: argparse.ArgumentParser) -> None:
    """Add the options that change a scene."""
    parser.add_argument(
        "--set",
        metavar="COMPONENT.VARIABLE=VALUE",
        type=setting,
        action="append",
        default=[],
        help="a start value, also as pi/2 or 90deg; enumerations by item name or number; may be "
        "repeated",
    )
    parser.add_argument("--stop", metavar="T", type=seconds, help="stop time in s")
    parser.add_argument("--step", metavar="H", type=seconds, help="macro step in s")
    parser.add_argument("--algorithm", choices=ALGORITHMS, help="how coupled components advance")
    parser.add_argument(
        "--hold", choices=HOLDS, help="inputs over a macro step: held, or linear in time"
    )
    parser.add_argument(
        "--adaptive",
        metavar="TOL",
        type=float,
        help="choose the macro step: bound on the relative error per second",
    )
    parser.add_argument("--variant", metavar="NAME", help="take this variant of the scene")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the options that change and run a scene."""
    configure_changes(parser)
    parser.add_argument(
        "--variants", action="store_true", help="run the scene and all its variants"
    )
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=file_of(*FORMATS),
        help="write the result here; the name's ending is the format: " + ", ".join(FORMATS),
    )
    parser.add_argument(
        "--units",
        action="store_true",
        help="in a CSV, write units behind the names: 'body.x [m]', as pandas, "
        "spreadsheets and `curvebound replay` read them",
    )


def chosen(scene: AnyScene, options: argparse.Namespace) -> list[tuple[str, AnyScene]]:
    """The scenes to run, each with a label: the scene or its variants, changed by the options."""
    if not options.variants:
        return [(options.variant or scene.name, changed(scene, options))]
    scenes = [(scene.name, scene)]
    scenes += [(name, scene.with_variant(name)) for name in scene.variants]
    return [(label, changed(one, options)) for label, one in scenes]


def changed(scene: AnyScene, options: argparse.Namespace) -> AnyScene:
    """A copy of the scene with the options applied; later ones prevail over a variant."""
    scene = scene.copy() if options.variant is None else scene.with_variant(options.variant)
    if options.stop is not None:
        scene.stop_time = options.stop
    if options.step is not None:
        scene.step = options.step
    if options.algorithm is not None:
        scene.algorithm = options.algorithm
    if options.hold is not None:
        scene.hold = options.hold
    if options.adaptive is not None:
        scene.adaptive = Adaptive(tolerance=options.adaptive)
    for path, value in options.set:
        scene.set(path, value)
    return scene
