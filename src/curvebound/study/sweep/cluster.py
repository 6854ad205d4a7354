"""Workers of a Dask cluster: the same task, sent elsewhere."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ...errors import CurveboundError
from .task import Point, Row, Task, run_points

__all__ = ["connect", "run_on_cluster"]

_PER_WORKER = 12  # chunks per worker thread: short enough to even out, long enough to be few
_LONGEST = 64


def connect(address: str) -> Any:
    """A client of the scheduler at `address`, to be closed; CurveboundError where none answers."""
    import importlib

    distributed: Any = importlib.import_module("distributed")
    try:
        return distributed.Client(address, timeout="15s")
    except (OSError, TimeoutError, ValueError) as error:
        raise CurveboundError(
            f"No Dask scheduler answers at {address}: {error}. Start one with `dask scheduler` and "
            "workers with `dask worker ADDRESS` in an environment that has curvebound."
        ) from error


def run_on_cluster(task: Task, points: Sequence[Point], client: Any) -> Iterator[list[Row]]:
    """Rows of all points, as they come in from the workers of a client's scheduler.

    Dask gives the work of a worker that dies to others. Where workers die on a chunk again and
    again its points are sent one by one, and the one that still fails becomes a failed row.
    """
    import importlib

    distributed: Any = importlib.import_module("distributed")
    threads = max(1, sum(client.nthreads().values()))
    size = max(1, min(_LONGEST, len(points) // (_PER_WORKER * threads) or 1))
    chunks = [list(points[i : i + size]) for i in range(0, len(points), size)]
    futures: dict[Any, list[Point]] = {}

    def send(chunk: list[Point]) -> Any:
        future = client.submit(run_points, task, chunk, pure=False, retries=2)
        futures[future] = chunk
        return future

    running = distributed.as_completed([send(chunk) for chunk in chunks])
    for future in running:
        chunk = futures.pop(future)
        cause = future.exception() if future.status == "error" else None
        if cause is None:
            yield future.result()
        elif isinstance(cause, CurveboundError):
            raise cause
        elif len(chunk) > 1:
            for point in chunk:
                running.add(send([point]))
        else:
            message = f"the workers failed on it: {type(cause).__name__}: {cause}"
            yield [(chunk[0][0], [None] * len(task.metrics), message)]
