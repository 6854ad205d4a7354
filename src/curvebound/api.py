"""What scripts call: run a scene, choose its setting, sweep its parameters.

Each is a function here and in `curvebound` itself; what they stand on can be used alone
(Prepared, Tuner, Study, Sweep).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from pathlib import Path

from .cosim.fmu import Value
from .cosim.load import load_scene
from .cosim.results import Result
from .cosim.scene import Scene
from .errors import CurveboundError
from .study.settings import study_outputs
from .study.sweep.design import Design, axis
from .study.sweep.engine import Sweep, SweepResult
from .study.tune.candidate import Choice
from .study.tune.tuner import Tuner

__all__ = ["run", "sweep", "tune"]


def run(
    scene: Scene | str | Path,
    start: Mapping[str, Value] | None = None,
    *,
    stop_time: float | None = None,
    step: float | None = None,
) -> Result:
    """Run a scene once.

    Parameters
    ----------
    scene : Scene or str or Path
        The scene, the name of one that comes with the package, or a file (.py, .ssp).
    start : mapping of str to float, int, bool or str, optional
        Start values by path ``component.variable`` on top of the scene's, in the unit of the
        variable; enumerations by item name or number. The scene itself is left as it is.
    stop_time, step : float, optional
        Stop time and macro step in s, instead of the scene's.

    Returns
    -------
    Result
        Arrays of shape (points,) by path: ``result["bead.bead.angle"]``, ``result.time`` in s.

    Raises
    ------
    CurveboundError
        The scene does not hold together; the message lists all that is wrong.
    RunFailed
        A component failed; ``result`` of the error holds what was recorded until then.
    """
    loaded = scene if isinstance(scene, Scene) else load_scene(scene)
    with loaded.prepare() as prepared:
        return prepared.run(start, stop_time=stop_time, step=step)


def tune(
    scene: Scene | str | Path,
    bounds: Mapping[str, float] | float | None = None,
    *,
    budget: float | None = None,
    continuous: bool = False,
    frame_rate: float | None = None,
    keep: Mapping[str, str] | None = None,
    limit: float = 5.0,
) -> Choice:
    """Find the cheapest setting of a scene that meets error bounds, and check it by running it.

    Parameters
    ----------
    scene : Scene or str or Path
        As for `run`.
    bounds : mapping of str to float, or float, optional
        Largest error at any time by output path, in the unit of the output; one number holds for
        all outputs that the scene is judged by. Default: what the scene needs.
    budget : float, optional
        CPU seconds per simulated second that the choice may take (default: what the scene needs).
    continuous : bool
        Judge control and inputs as acting all the time, not held over a macro step: then the macro
        step is chosen too.
    frame_rate : float, optional
        Communication points per second that must be recorded, in Hz.
    keep : mapping of str to str, optional
        Enumerations that stay as given, by path.
    limit : float
        CPU seconds that one run may take.

    Returns
    -------
    Choice
        ``chosen.setting`` (None where nothing fits), its errors and cost, what comes next.

    Raises
    ------
    CurveboundError
        There is no bound, nothing to choose, no reference, or scipy or mpmath is not installed.
    """
    loaded = scene if isinstance(scene, Scene) else load_scene(scene)
    needed = {path: bound for path, bound in loaded.needs.errors.items() if bound > 0.0}
    if isinstance(bounds, Mapping):
        needed = dict(bounds)
    elif bounds is not None:
        needed = dict.fromkeys(study_outputs(loaded, loaded.check()), bounds)
    if not needed:
        raise CurveboundError(
            f"The scene {loaded.name} does not say what error it allows: give bounds, or set "
            "`needs` in the scene."
        )
    tuner = Tuner(
        loaded,
        list(needed),
        continuous=continuous,
        frame_rate=frame_rate,
        limit=limit,
        keep=keep,
    )
    with closing(tuner):
        return tuner.tune(needed, budget=loaded.needs.budget if budget is None else budget)


def sweep(
    scene: str | Path,
    vary: Sequence[str],
    out: str | Path,
    *,
    metrics: Sequence[str] = (),
    start: Mapping[str, Value] | None = None,
    latin: int = 0,
    seed: int = 0,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[int, int, int], None] | None = None,
) -> SweepResult:
    """Run a scene over a grid or a Latin hypercube of its parameters, on all cores.

    Parameters
    ----------
    scene : str or Path
        Name or file of the scene (each process loads it).
    vary : sequence of str
        One axis each: ``"component.variable=LOW:HIGH:N"``, with ``:log`` for equal steps in the
        logarithm, or ``"component.variable=a,b,c"``; values in the unit of the variable.
    out : str or Path
        CSV or Parquet file, one row for each point. Points that it holds already are not run.
    metrics : sequence of str
        Expressions that end in one number, as ``"max(abs(plant.pendulum.angle))"``, see
        `curvebound.study.sweep.Metric`. Default: final and largest values of the main outputs.
    start : mapping, optional
        Start values by path on top of the scene's.
    latin : int
        Number of points of a Latin hypercube instead of a grid (0: the grid).
    seed : int
        Of the hypercube.
    workers : int, optional
        Processes (default: one for each core).
    scheduler : str, optional
        Address of a Dask scheduler, whose workers run the points instead.
    progress : callable, optional
        Called with the numbers of points done, of all points, and of failed ones.

    Returns
    -------
    SweepResult
        The file, and how many points there are, were run now, and failed.

    Raises
    ------
    CurveboundError
        An axis, metric or file that does not make sense; nothing has been run then.
    """
    design = Design([axis(text) for text in vary], latin, seed)
    made = Sweep(str(scene), design, metrics, changes=start)
    return made.run(Path(out), workers=workers, scheduler=scheduler, progress=progress)
