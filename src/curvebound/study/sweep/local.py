"""Workers on this machine: processes that are replaced when they die.

An FMU can take its process down. A pool of concurrent.futures, joblib's as well, is broken by that:
all that was given to it fails, and it cannot tell which point was the cause.
"""

from __future__ import annotations

import multiprocessing
import time as clock
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from typing import Any

from ...errors import CurveboundError
from .task import Point, Row, Task, run_points

__all__ = ["run_locally"]

_CHUNK = 0.3  # s that a worker is given work for at once
_TRIES = 3  # deaths of a worker on one point until the point counts as the cause


def run_locally(task: Task, points: Sequence[Point], workers: int) -> Iterator[list[Row]]:
    """Rows of all points, in the order in which they are done, some at a time.

    A worker that dies loses nothing: what it had not reported is given to others, point by point; a
    point on which a worker died three times is a failed row.
    """
    pool = _Pool(task, points, workers)
    try:
        yield from pool.run()
    finally:
        pool.stop()


@dataclass
class _Worker:
    process: Any
    pipe: Connection
    busy: list[Point] = field(default_factory=list)
    began: float = 0.0
    started: bool = False


class _Pool:
    def __init__(self, task: Task, points: Sequence[Point], workers: int) -> None:
        self.task = task
        # spawned, not forked: a loaded FMU and a running thread do not survive a fork for certain
        self.context = multiprocessing.get_context("spawn")
        self.waiting: deque[Point] = deque(points)
        self.alone: deque[Point] = deque()  # points to be run one by one
        self.tries: dict[int, int] = {}
        self.left = len(points)
        self.size = 1
        self.deaths = 0
        self.workers = [self._start() for _ in range(max(1, min(workers, len(points))))]

    def _start(self) -> _Worker:
        ours, theirs = self.context.Pipe()
        process = self.context.Process(target=_serve, args=(theirs, self.task), daemon=True)
        process.start()
        theirs.close()
        return _Worker(process, ours)

    def run(self) -> Iterator[list[Row]]:
        while self.left:
            for worker in self.workers:
                if not worker.busy:
                    self._feed(worker)
            ready = wait([w.pipe for w in self.workers], timeout=1.0)
            for worker in list(self.workers):
                if worker.pipe not in ready and worker.process.is_alive():
                    continue
                rows = self._hear(worker)
                if rows:
                    self.left -= len(rows)
                    yield rows

    def _feed(self, worker: _Worker) -> None:
        if self.waiting:
            count = min(self.size, max(1, len(self.waiting) // (2 * len(self.workers))))
            worker.busy = [self.waiting.popleft() for _ in range(min(count, len(self.waiting)))]
        elif self.alone:
            worker.busy = [self.alone.popleft()]
        if worker.busy:
            worker.began = clock.perf_counter()
            with suppress(OSError):  # it has died: heard of when its pipe is read
                worker.pipe.send(worker.busy)

    def _hear(self, worker: _Worker) -> list[Row]:
        try:
            rows = worker.pipe.recv()
        except (EOFError, OSError):
            return self._bury(worker)
        if isinstance(rows, str):
            raise CurveboundError(rows)
        if not worker.started:
            worker.started = True  # the first answer took the loading of the FMUs too
        else:
            took = max(clock.perf_counter() - worker.began, 1e-6) / len(worker.busy)
            self.size = max(1, min(int(_CHUNK / took), 2 * self.size))
        worker.busy = []
        answer: list[Row] = rows
        return answer

    def _bury(self, worker: _Worker) -> list[Row]:
        """Replace a dead worker; rows of points that have killed too many."""
        worker.process.join(timeout=5.0)
        code = worker.process.exitcode
        worker.pipe.close()
        self.deaths += 1
        if self.deaths > 10 + 2 * len(self.workers) and self.left == len(self.waiting):
            raise CurveboundError(
                f"Worker processes die before they have done anything (exit code {code}); run one "
                "point with `curvebound run` to see why."
            )
        failed: list[Row] = []
        for point in worker.busy:
            number = point[0]
            self.tries[number] = self.tries.get(number, 0) + (1 if len(worker.busy) == 1 else 0)
            if self.tries[number] >= _TRIES:
                nothing = [None] * len(self.task.metrics)
                failed.append(
                    (number, nothing, f"the worker process died on it {_TRIES} times (exit {code})")
                )
            else:
                self.alone.append(point)
        self.workers[self.workers.index(worker)] = self._start()
        return failed

    def stop(self) -> None:
        """End all workers, idle or not."""
        for worker in self.workers:
            with suppress(OSError):
                worker.pipe.send(None)
            worker.pipe.close()
        for worker in self.workers:
            worker.process.join(timeout=0.5)
            if worker.process.is_alive():
                worker.process.terminate()
                worker.process.join()


def _serve(pipe: Connection, task: Task) -> None:
    """Answer lists of points with lists of rows until told to stop, or the parent has gone."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # ctrl-C is the parent's business
    with suppress(EOFError, OSError):
        while True:
            points = pipe.recv()
            if points is None:
                return
            try:
                answer: Any = run_points(task, points)
            except CurveboundError as error:
                answer = str(error)
            pipe.send(answer)
