"""Sweeps: designs, metrics, resuming, failed points, dying workers."""

from __future__ import annotations

import csv
import math
import multiprocessing
import os
import signal
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from curvebound.cosim import load_scene
from curvebound.errors import CurveboundError
from curvebound.study.sweep import Design, Metric, Sweep, axis, local
from curvebound.study.sweep.cluster import run_on_cluster
from curvebound.study.sweep.local import _Pool
from curvebound.study.sweep.task import Task, run_points

DAMPING = "bead.bead.damping=0:1:{}"
METRICS = ["final(bead.bead.y)", "max(abs(bead.bead.x))"]


def rows_of(path: Path) -> list[list[str]]:
    with path.open(newline="") as file:
        return list(csv.reader(file))


def sweep(points: int = 6, vary: str = DAMPING) -> Sweep:
    return Sweep(
        "bead_on_wire", Design([axis(vary.format(points))]), METRICS, changes={"stop_time": 1.0}
    )


def test_grid_visits_every_combination_once_with_exact_ends() -> None:
    design = Design([axis("a.x=1:100:3:log"), axis("a.y=0:1:4"), axis("a.m=rk4,adaptive")])
    points = list(design)
    assert len(design) == len(points) == 24
    assert len({tuple(p.values()) for p in points}) == 24
    assert sorted({p["a.x"] for p in points}) == pytest.approx([1.0, 10.0, 100.0], rel=1e-14)
    assert {p["a.y"] for p in points} >= {0.0, 1.0}


def test_grids_hit_round_numbers_and_ranges_beyond_squares_of_doubles() -> None:
    assert axis("a.method=1:6:6").values() == [1, 2, 3, 4, 5, 6]
    assert axis("a.x=0:1:11").values() == [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1]
    assert axis("a.x=1e-200:1e-190:3:log").values() == pytest.approx([1e-200, 1e-195, 1e-190])


def test_latin_hypercube_has_one_point_in_each_slice() -> None:
    design = Design([axis("a.x=0:1"), axis("a.y=0:1")], latin=50, seed=3)
    for path in ("a.x", "a.y"):
        slices = sorted(int(50 * float(p[path])) for p in design)
        assert slices == list(range(50))
    again = Design([axis("a.x=0:1"), axis("a.y=0:1")], latin=50, seed=3)
    assert list(again) == list(design)


@pytest.mark.parametrize("text", ["a", "a.x=", "a.x=1:2:0", "a.x=-1:2:3:log", "a.x=1:nan:3"])
def test_a_bad_axis_is_refused(text: str) -> None:
    with pytest.raises(CurveboundError, match="--vary"):
        axis(text)


DATA = np.array(
    [(0.0, 1.0, -3.0), (1.0, 2.0, 4.0), (2.0, 4.0, 0.0)],
    dtype=[("time", float), ("a.x", float), ("a.b.y", float)],
)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("max(abs(a.b.y))", 4.0),
        ("final(a.x) - first(a.x)", 3.0),
        ("at(a.x, 1.5)", 3.0),
        ("when(a.x > 1.5)", 1.0),
        ("rms(a.b.y)", math.sqrt(25.0 / 3.0)),
        ("span(a.x) ** 2 / 3", 3.0),
    ],
)
def test_metric(text: str, value: float) -> None:
    assert Metric(text)(DATA) == pytest.approx(value, rel=1e-14)


def test_metric_of_nothing_that_holds_is_nan() -> None:
    assert math.isnan(Metric("when(a.x > 9)")(DATA))


@pytest.mark.parametrize(
    "text", ["__import__('os')", "a.x.__class__()", "open", "max(a.x, 1)", "[a.x]", "max("]
)
def test_a_metric_that_says_more_than_arithmetic_is_refused(text: str) -> None:
    with pytest.raises(CurveboundError, match="metric"):
        Metric(text)


@pytest.mark.parametrize("text", ["-" * 20000 + "1", "-" * 200 + "1", "1" + "+1" * 3000])
def test_a_metric_that_is_nested_too_deeply_is_refused(text: str) -> None:
    with pytest.raises(CurveboundError, match="nested too deeply"):
        Metric(text)


def test_a_metric_that_is_no_single_number_says_what_to_do() -> None:
    with pytest.raises(CurveboundError, match="wrap it"):
        Metric("a.x + 1")
    with pytest.raises(CurveboundError, match="wrap it"):
        Metric("at(a.x, time)")


def test_a_time_beyond_the_end_is_no_number_and_refused_before_the_first_run() -> None:
    assert math.isnan(Metric("at(a.x, 2.1)")(DATA))
    design = Design([axis(DAMPING.format(3))])
    with pytest.raises(CurveboundError, match=r"t = 1e\+09 s, and the run lasts from 0 s to"):
        Sweep("bead_on_wire", design, ["at(bead.bead.y, 1e9)"])


def test_the_same_metric_twice_is_refused() -> None:
    with pytest.raises(CurveboundError, match=r"'final\(bead.bead.y\)' is given twice"):
        Sweep("bead_on_wire", Design([axis(DAMPING.format(3))]), [METRICS[0], " " + METRICS[0]])


def test_too_many_points_are_refused_at_once() -> None:
    with pytest.raises(CurveboundError, match=r"1000000000 points, and may have 1000000 at most"):
        Design([axis("a.x=1:2:1000000000")])


def test_a_value_that_is_not_finite_is_named() -> None:
    for text in ("a.x=nan:2:3", "a.x=1,inf"):
        with pytest.raises(CurveboundError, match="values must be finite"):
            axis(text)


@pytest.mark.usefixtures("points_here")
def test_an_interrupted_sweep_goes_on_and_ends_the_same(tmp_path: Path) -> None:
    whole = sweep(12).run(tmp_path / "whole.csv", workers=1)
    table = rows_of(whole.path)
    assert table[0] == ["point", "bead.bead.damping", *METRICS, "message"]
    assert [(int(row[0]), float(row[1])) for row in table[1:]] == [(i, i / 11) for i in range(12)]
    complete = whole.path.read_bytes()
    lines = complete.decode().splitlines(keepends=True)
    whole.path.write_text("".join(lines[:4]) + lines[4][:7])  # killed in the middle of a row
    result = sweep(12).run(whole.path, workers=1)
    assert result.run == 9
    assert whole.path.read_bytes() == complete


def test_the_file_of_another_sweep_is_left_alone(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    out.write_text("point,mine\n")
    with pytest.raises(CurveboundError, match="--restart"):
        sweep().run(out)
    assert out.read_text() == "point,mine\n"


def test_a_failed_point_is_a_row_with_its_message(tmp_path: Path) -> None:
    """Of a worker of its own, as every sweep has them."""
    result = sweep(3, "bead.wire.radius=-1:1:{}").run(tmp_path / "a.csv", workers=1)
    rows = rows_of(result.path)[1:]
    assert result.failed == 2
    assert [bool(row[-1]) for row in rows] == [True, True, False]
    assert "wire.radius = -1.0" in rows[0][-1]
    assert rows[2][2] != ""


@pytest.mark.parametrize("start", ["fork", pytest.param("spawn", marks=pytest.mark.slow)])
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")  # has threads, and forks
def test_a_killed_worker_loses_no_point(monkeypatch: pytest.MonkeyPatch, start: str) -> None:
    """Of processes that are forked, which is quicker, where the points need no FMU."""
    if start == "fork":
        if sys.platform == "win32":
            pytest.skip("Windows has no fork")
        forked = multiprocessing.get_context("fork")
        monkeypatch.setattr(local.multiprocessing, "get_context", lambda _: forked)
        monkeypatch.setattr(
            local, "run_points", lambda _, points: [(n, [1.0, 2.0], "") for n, _ in points]
        )
    made = sweep(40)
    pool = _Pool(made.task, [(i, made.design[i]) for i in range(40)], 2)
    found: list[int] = []
    killed = False
    try:
        for rows in pool.run():
            found += [number for number, _, message in rows if not message]
            if not killed and len(found) >= 4:
                victim = next(w for w in pool.workers if w.process.is_alive())
                os.kill(victim.process.pid, signal.SIGKILL)  # one that this test started
                killed = True
    finally:
        pool.stop()
    assert killed
    assert pool.deaths >= 1
    assert sorted(found) == list(range(40))


@pytest.mark.usefixtures("points_here")
def test_parquet_holds_the_same_and_is_not_overwritten(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    vary = "bead.wire.radius=-1:1:{}"
    table = parquet.read_table(sweep(3, vary).run(tmp_path / "a.parquet", workers=1).path)
    rows = rows_of(sweep(3, vary).run(tmp_path / "a.csv", workers=1).path)
    assert table.column_names == rows[0]
    assert table.column("point").to_pylist() == [0, 1, 2]
    for i, name in enumerate(rows[0][1:-1], 1):
        assert table.column(name).to_pylist() == [
            float(row[i]) if row[i] else None for row in rows[1:]
        ]
    assert [bool(text) for text in table.column("message").to_pylist()] == [True, True, False]
    assert not list(tmp_path.glob("*.part"))
    with pytest.raises(CurveboundError, match="--restart"):
        sweep(3, vary).run(tmp_path / "a.parquet", workers=1)


@pytest.mark.usefixtures("points_here")
def test_an_interrupted_parquet_goes_on(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    out = tmp_path / "a.parquet"

    def stop(done: int, count: int, failed: int) -> None:
        if done >= 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep().run(out, workers=1, progress=stop)
    assert not out.exists()
    kept = len(rows_of(tmp_path / "a.csv.part")) - 1
    result = sweep().run(out, workers=1)
    assert result.run == 6 - kept < 6
    assert parquet.read_table(out).column("point").to_pylist() == list(range(6))


@pytest.mark.slow
def test_a_sweep_on_a_cluster_from_the_command_line(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    from curvebound.cli import main

    out = tmp_path / "cluster.csv"
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=True, dashboard_address=None
    ) as cluster:
        words = ["sweep", "bead_on_wire", "--vary", DAMPING.format(6), "--set", "stop_time=1"]
        for metric in METRICS:
            words += ["--metric", metric]
        words += ["--scheduler", cluster.scheduler_address, "--out", str(out)]
        assert main(words) == 0
    alone = sweep().run(tmp_path / "alone.csv", workers=1)
    assert out.read_bytes() == alone.path.read_bytes()


def test_a_scheduler_that_is_not_there_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("distributed")
    client = distributed.Client
    monkeypatch.setattr(
        distributed, "Client", lambda address, timeout: client(address, timeout="1s")
    )
    out = tmp_path / "a.csv"
    for earlier in (None, "point,mine\n"):
        if earlier is not None:
            out.write_text(earlier)
        with pytest.raises(CurveboundError, match=r"tcp://127\.0\.0\.1:9"):
            sweep().run(out, scheduler="tcp://127.0.0.1:9", restart=True)
        assert [file.read_text() for file in tmp_path.iterdir()] == ([earlier] if earlier else [])


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CurveboundError, match=r"x\.csv cannot be written"):
        sweep().run(tmp_path / "file" / "x.csv")


@pytest.mark.slow
def test_a_killed_worker_of_a_cluster_loses_no_point(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    made = sweep(60)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        killed: list[int] = []

        def kill(done: int, count: int, failed: int) -> None:
            if done >= 5 and not killed:
                worker = next(iter(cluster.workers.values()))
                killed.append(worker.pid)
                os.kill(worker.pid, signal.SIGKILL)  # the cluster of this test

        result = made.run(tmp_path / "a.csv", scheduler=cluster.scheduler_address, progress=kill)
    assert killed
    rows = rows_of(result.path)[1:]
    assert [int(row[0]) for row in rows] == list(range(60))
    assert not any(row[-1] for row in rows)
    alone = sweep(60).run(tmp_path / "b.csv", workers=1)
    assert alone.path.read_bytes() == result.path.read_bytes()


@pytest.mark.usefixtures("points_here")
def test_a_second_sweep_into_one_file_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "a.csv"
    refused: list[str] = []

    def second(done: int, count: int, failed: int) -> None:
        if done and not refused:
            with pytest.raises(CurveboundError) as caught:
                sweep().run(out, workers=1)
            refused.append(str(caught.value))

    result = sweep().run(out, workers=1, progress=second)
    assert f"is being written by process {os.getpid()}" in refused[0]
    assert result.points == len(rows_of(out)) - 1 == 6


@pytest.mark.usefixtures("points_here")
@pytest.mark.parametrize("loss", ["a row", "the file"])
def test_rows_that_others_have_lost_are_missed(tmp_path: Path, loss: str) -> None:
    out = tmp_path / "a.csv"

    def lose(done: int, count: int, failed: int) -> None:
        if done == count:
            if loss == "a row":
                lines = out.read_text().splitlines(keepends=True)
                out.write_text("".join(lines[:2] + lines[3:]))
            else:
                out.rename(tmp_path / "b.csv")

    with pytest.raises(CurveboundError, match=r"a\.csv"):
        sweep().run(out, workers=1, progress=lose)


class Cluster:
    """A client of a scheduler without processes: workers die on the points in `deadly`."""

    def __init__(self, threads: int, deadly: tuple[int, ...] = (), error: Exception | None = None):
        self.threads = threads
        self.deadly = deadly
        self.error = error or RuntimeError("no memory")
        self.sent: list[list[int]] = []

    def nthreads(self) -> dict[str, int]:
        return {"one": self.threads - self.threads // 2, "two": self.threads // 2}

    def submit(self, run: Any, task: Any, chunk: Any, *, pure: bool, retries: int) -> Any:
        assert (run, pure, retries) == (run_points, False, 2)
        numbers = [number for number, _ in chunk]
        self.sent.append(numbers)
        return Answer(self, numbers)


class Answer:
    def __init__(self, client: Cluster, numbers: list[int]) -> None:
        self.numbers = numbers
        self.error = client.error
        self.status = "error" if set(numbers) & set(client.deadly) else "finished"

    def exception(self) -> Exception:
        return self.error

    def result(self) -> list[Any]:
        return [(number, [1.0], "") for number in self.numbers]


class Completed(list[Any]):
    """What distributed.as_completed gives, in the order of sending."""

    def add(self, future: Any) -> None:
        self.append(future)


@pytest.fixture
def completing(monkeypatch: pytest.MonkeyPatch) -> None:
    module = SimpleNamespace(as_completed=Completed)
    monkeypatch.setitem(sys.modules, "distributed", module)


@pytest.mark.parametrize(
    ("took", "sizes"),
    [(2.0, [1, 1]), (2.0**-10, [2, 4, 8, 16, 32, 64, 128, 256, 307, 307]),
     (2.0**-17, [*(2**n for n in range(1, 16)), 39321, 39321])],
)  # fmt: skip
def test_a_worker_is_given_what_takes_three_tenths_of_a_second(
    monkeypatch: pytest.MonkeyPatch, took: float, sizes: list[int]
) -> None:
    """Twice as many points as before at most, until that is reached."""
    monkeypatch.setattr(_Pool, "_start", lambda pool: None)
    pool = _Pool(None, [], 1)  # type: ignore[arg-type]
    pipe: Any = SimpleNamespace(recv=list)
    for size in sizes:
        worker = local._Worker(None, pipe, [(0, {})] * pool.size, started=True)
        now = SimpleNamespace(perf_counter=lambda took=took * pool.size: took)
        monkeypatch.setattr(local, "clock", now)
        pool._hear(worker)
        assert pool.size == size


@pytest.mark.parametrize(
    ("threads", "count", "longest"),
    [(1, 5, 1), (1, 12, 1), (1, 23, 1), (1, 24, 2), (3, 144, 4), (1, 768, 64), (1, 5000, 64)],
)
@pytest.mark.usefixtures("completing")
def test_chunks_for_a_cluster_are_a_twelfth_of_a_workers_share(
    threads: int, count: int, longest: int
) -> None:
    client = Cluster(threads)
    points = [(number, {}) for number in range(count)]
    rows = list(run_on_cluster(SimpleNamespace(metrics=("x",)), points, client))
    assert [row[0] for chunk in rows for row in chunk] == list(range(count))
    assert {len(chunk) for chunk in client.sent[:-1]} <= {longest}
    assert 1 <= len(client.sent[-1]) <= longest


@pytest.mark.usefixtures("completing")
def test_points_on_which_workers_die_are_sent_alone() -> None:
    client = Cluster(1, deadly=(5,))
    points = [(number, {}) for number in range(36)]
    task = SimpleNamespace(metrics=("x", "y"))
    rows = [row for chunk in run_on_cluster(task, points, client) for row in chunk]
    assert [numbers for numbers in client.sent if 5 in numbers] == [[3, 4, 5], [5]]
    assert client.sent[12:] == [[3], [4], [5]]
    assert sorted(row[0] for row in rows) == list(range(36))
    failed = [row for row in rows if row[2]]
    assert failed == [(5, [None, None], "the workers failed on it: RuntimeError: no memory")]
    stopped = Cluster(1, deadly=(5,), error=CurveboundError("no such scene"))
    with pytest.raises(CurveboundError, match="no such scene"):
        list(run_on_cluster(task, points, stopped))


def test_points_record_what_their_metrics_use() -> None:
    metrics = ("max(plant.parabola.force)", "min(plant.slider.u) + max(plant.parabola.force)")
    scene = Task("pendulum_small", None, (), metrics).scene()
    assert scene.recorded == ["plant.parabola.force", "plant.slider.u"]
    scene = Task("pendulum_small", None, (), ()).scene()
    assert scene.recorded == load_scene("pendulum_small").recorded
