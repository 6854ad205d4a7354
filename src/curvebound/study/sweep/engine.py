"""A sweep from beginning to end: resumed where it was stopped, on processes or on a cluster."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ... import __version__
from ...cosim.fmu import Value
from ...cosim.scene import Scene
from ...cosim.system import port_of
from ...errors import CurveboundError, nearest
from ...files import sole_writer
from ..identity import identity
from .cluster import connect, run_on_cluster
from .design import Design
from .local import run_locally
from .metrics import Metric
from .store import Store
from .task import Point, Row, Task

__all__ = ["Sweep", "SweepResult", "cores"]

Progress = Callable[[int, int, int], None]  # points done, points in all, failed ones


def cores() -> int:
    """Processor cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


@dataclass(frozen=True)
class SweepResult:
    """A finished sweep.

    Attributes
    ----------
    path : Path
        The file with one row for each point.
    points, run, failed : int
        How many points there are, were run now, and failed.
    """

    path: Path
    points: int
    run: int
    failed: int


class Sweep:
    """A scene over a design, checked before anything runs.

    which: the scene's name or file; metrics: expressions, see Metric (default: final value and
    largest size of the outputs that the scene needs, else of the first six that it records).
    changes: settings by path on top of the scene's.
    """

    def __init__(
        self,
        which: str,
        design: Design,
        metrics: Sequence[str] = (),
        *,
        changes: Mapping[str, Value] | None = None,
        variant: str | None = None,
    ) -> None:
        path = Path(which)
        text = path.read_bytes() if path.suffix in (".py", ".ssp") and path.is_file() else None
        self.design = design
        settings = tuple((changes or {}).items())
        bare = Task(which, text, settings, (), variant)
        scene = bare.scene()
        given = [Metric(m) for m in metrics]
        for metric in given:
            metric.require_within(scene.start_time, scene.stop_time)
        self.metrics = [metric.text for metric in given] or _default_metrics(scene)
        twice = [m for i, m in enumerate(self.metrics) if m in self.metrics[:i]]
        if twice:
            raise CurveboundError(f"The metric {twice[0]!r} is given twice; keep one of them.")
        self.task = Task(which, text, settings, tuple(self.metrics), variant)
        self.scene = self.task.scene()
        system = self.scene.check()
        for one in design.axes:
            name, variable = port_of(one.path)
            node = system.nodes.get(name)
            known = [v.name for v in node.fmu.variables.values() if v.is_settable_start] if (
                node is not None
            ) else []  # fmt: skip
            if variable not in known:
                every = [
                    f"{n.name}.{v.name}"
                    for n in system.nodes.values()
                    for v in n.fmu.variables.values()
                    if v.is_settable_start
                ]
                raise CurveboundError(
                    f"--vary {one.path}: {nearest(one.path, every)} A sweep varies start values "
                    "and parameters of the scene's components."
                )
            if one.path in dict(settings):
                raise CurveboundError(
                    f"--set {one.path} would be ignored, as --vary {one.path} gives its values: "
                    "leave one of them out."
                )
            assert node is not None
            for value in one.items or (one.low, one.high):
                try:
                    node.fmu.variables[variable].value(value)
                except ValueError as error:
                    raise CurveboundError(f"--vary {one.path}: {error}.") from None
        described = {
            "scene": identity(system),
            "axes": [str(one) for one in design.axes],
            "latin": [design.latin, design.seed],
            "metrics": self.metrics,
            "version": __version__,
        }
        text_of = json.dumps(described, sort_keys=True)
        self.identity = hashlib.sha256(text_of.encode()).hexdigest()[:16]

    def run(
        self,
        out: Path,
        *,
        workers: int | None = None,
        scheduler: str | None = None,
        restart: bool = False,
        progress: Progress | None = None,
    ) -> SweepResult:
        """Run the points that `out` does not hold yet.

        workers: processes (default: one per core); scheduler: address of a Dask scheduler instead.
        KeyboardInterrupt leaves what is done in the file; the next run goes on from there.
        """
        store = Store(out, self.identity, [a.path for a in self.design.axes], self.metrics)
        if scheduler is not None:
            from ..extras import require

            require("sweep")
        with sole_writer(out):
            done = store.look(restart=restart)
            missing: list[Point] = [
                (i, self.design[i]) for i in range(len(self.design)) if i not in done
            ]
            failed = 0
            finished = len(done)
            # before a file is touched: without a cluster nothing can take the place of its rows
            client = connect(scheduler) if scheduler is not None and missing else None
            try:
                store.open()
                if progress is not None:
                    progress(finished, len(self.design), failed)
                for rows in self._batches(missing, client, workers):
                    store.add(rows, self.design)
                    finished += len(rows)
                    failed += sum(bool(message) for _, _, message in rows)
                    if progress is not None:
                        progress(finished, len(self.design), failed)
            finally:
                if client is not None:
                    client.close()
            path = store.finish(len(self.design))
        return SweepResult(path, len(self.design), len(missing), failed)

    def _batches(
        self, missing: Sequence[Point], client: Any, workers: int | None
    ) -> Iterator[list[Row]]:
        if client is not None:
            return run_on_cluster(self.task, missing, client)
        if missing:
            return run_locally(self.task, missing, workers or cores())
        return iter(())


def _default_metrics(scene: Scene) -> list[str]:
    system = scene.check()
    paths = list(scene.needs.errors) or [
        ".".join(port) for port in system.recorded if system.variable(port).kind == "Real"
    ]
    return [text for path in paths[:6] for text in (f"final({path})", f"max(abs({path}))")]
