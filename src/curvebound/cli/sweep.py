"""Run a scene over a grid or a sample of its parameters, on all cores or on a Dask cluster.

examples:
  curvebound sweep bead_on_wire --vary bead.bead.damping=0:1:11 --metric "final(bead.bead.y)"
  curvebound sweep pendulum_large --vary plant.slider.u_start=0.5:2:40 \\
      --vary plant.pendulum.angle_start=0:3:40 --metric "max(abs(plant.pendulum.angle))" --map
  curvebound sweep swaying_parabola --vary drive.waveform.frequency=0.1:2 --latin 500
  curvebound sweep bead_on_wire --vary bead.wire.radius=0.1:10:100:log --scheduler tcp://host:8786
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..arguments import setting, whole
from ..output import console_of, hand_out
from ..progress import Progress

NAME = "sweep"
HELP = "run a scene over a range of parameters"
AS_JSON = True


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("scene", metavar="SCENE", help="a .py or .ssp file, or a scene's name")
    parser.add_argument(
        "--vary",
        metavar="PATH=LOW:HIGH:N",
        action="append",
        default=[],
        help="a parameter and its values: LOW:HIGH:N, LOW:HIGH:N:log or a,b,c; may be repeated",
    )
    parser.add_argument(
        "--latin", type=whole(1), default=0, metavar="N", help="N points of a sample"
    )
    parser.add_argument("--seed", type=whole(0), default=0, help="of the sample (default: 0)")
    parser.add_argument(
        "--metric",
        metavar="EXPR",
        action="append",
        default=[],
        help="a number to keep of each run, such as max(abs(plant.body.x)); may be repeated",
    )
    parser.add_argument(
        "--set",
        metavar="PATH=VALUE",
        type=setting,
        action="append",
        default=[],
        help="a setting of all points",
    )
    parser.add_argument("--variant", metavar="NAME", help="of the scene")
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help=".csv or .parquet (default: build/sweep/SCENE.csv)"
    )
    parser.add_argument(
        "--workers", type=whole(1), metavar="N", help="processes (default: all cores)"
    )
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster")
    parser.add_argument("--restart", action="store_true", help="forget what an earlier run did")
    parser.add_argument(
        "--map", action="store_true", help="draw a heat map, where two parameters vary"
    )


def run(options: argparse.Namespace) -> int:
    """Sweep; a failed point is a row with its message, and no failure of the sweep."""
    from ..errors import CurveboundError
    from ..files import inside
    from ..study.extras import require
    from ..study.sweep import Design, Sweep, axis

    design = Design([axis(text) for text in options.vary], options.latin, options.seed)
    if options.map:
        require("plots")
        from ..study.sweep.heatmap import require_map

        require_map(design)
    sweep = Sweep(
        options.scene, design, options.metric, changes=dict(options.set), variant=options.variant
    )
    out = options.out or inside(Path("build", "sweep"), sweep.scene.name, ".csv")
    if options.map and out.suffix != ".csv":
        raise CurveboundError("--map draws from a CSV: give an --out that ends in .csv.")
    console = console_of(options)
    with Progress(f"sweep of {sweep.scene.name}", len(design), "points") as show:

        def tell(done: int, count: int, failed: int) -> None:
            show(done, count, f"{failed} failed" if failed else "")

        try:
            result = sweep.run(
                out,
                workers=options.workers,
                scheduler=options.scheduler,
                restart=options.restart,
                progress=tell,
            )
        except KeyboardInterrupt:
            console.print(f"Stopped; {out} holds what is done; the same command goes on.")
            return 1
    earlier = result.points - result.run
    text = f"{result.path}: {result.points} point{'' if result.points == 1 else 's'}"
    if earlier:
        text += f", {earlier} of them from an earlier run"
    if result.failed:
        text += f"; {result.failed} failed, see the column message"
    console.print(text, soft_wrap=True)
    drawn = []
    if options.map:
        from ..study.sweep.heatmap import draw_heat_map

        drawn = list(draw_heat_map(result.path, design, sweep.metrics, out.with_suffix("")))
        for path in drawn:
            console.print(str(path), soft_wrap=True)
    data = {"file": result.path, "points": result.points, "run": result.run}
    hand_out(options, {**data, "failed": result.failed, "maps": drawn})
    return 0
