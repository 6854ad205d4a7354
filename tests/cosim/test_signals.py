"""Scene inputs: constants, functions, tables, files, and the same values through fmpy."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest

from curvebound.cosim import Scene
from curvebound.cosim.signals import signal
from curvebound.errors import CurveboundError


def test_tables_are_linear_and_jump():
    f = signal(([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 5.0, 7.0]), "a.u")
    assert [f(t) for t in (-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 9.0)] == [0, 0, 0.5, 5, 6, 7, 7]
    assert f(1.0 - 1e-16) == 5.0  # a communication point within rounding of the jump


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (([], []), "0 times"),
        (([0.0, 1.0], [0.0]), "2 times and 1 values"),
        (([1.0, 0.0], [0.0, 0.0]), "go back"),
        (([0.0, 1.0], [0.0, float("nan")]), "NaN"),
    ],
)
def test_bad_tables_are_refused(table, message):
    with pytest.raises(CurveboundError, match=message):
        signal(table, "a.u")


def test_csv_files(tmp_path, gain_fmu):
    file = tmp_path / "in.csv"
    file.write_text("time,a.u\n0,1\n1,3\n")
    scene = Scene("csv", stop_time=1.0, step=0.5).add("a", gain_fmu).record("a.y")
    scene.input("a.u", file)
    assert list(scene.run()["a.y"]) == [1.0, 2.0, 3.0]
    scene = Scene("csv", stop_time=1.0, step=0.5).add("a", gain_fmu).record("a.y")
    scene.folder = tmp_path
    scene.input("a.u", "in.csv")
    assert list(scene.run()["a.y"]) == [1.0, 2.0, 3.0]
    file.write_text("time,b\n0,1\n")
    with pytest.raises(CurveboundError, match=r"must have the columns time and a\.u"):
        scene.run()


@pytest.mark.parametrize(
    "text",
    ["\ufefftime,mass.other\n0,1\n1,3\n", "time [ms],mass.other [kN]\n0,0.001\n1000,0.003\n"],
    ids=["mark of a spreadsheet", "other units"],
)
def test_csv_files_of_spreadsheets_and_of_other_units(text, tmp_path, mass_fmu):
    file = tmp_path / "in.csv"
    file.write_text(text, encoding="utf-8")
    table = signal(file, "mass.other", "N")
    assert callable(table)
    assert [table(t) for t in (0.0, 0.5, 1.0)] == pytest.approx([1.0, 2.0, 3.0], rel=1e-15)


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ("time [m],a.u", "column time: its unit, m, is none of s"),
        ("time,a.u [kg]", "column a.u: its unit, kg, is none of N"),
        ("time,a.u [x]", "column a.u: its unit, x, is none of N"),
    ],
)
def test_csv_files_of_another_quantity_are_refused(head, words, tmp_path):
    file = tmp_path / "in.csv"
    file.write_text(f"{head}\n0,1\n")
    with pytest.raises(CurveboundError, match=words):
        signal(file, "a.u", "N")


def test_tunable_parameters_can_be_driven(gain_fmu):
    scene = Scene("tuned", stop_time=1.0, step=0.25).add("a", gain_fmu).record("a.y")
    scene.input("a.tuned", lambda t: 10.0 * t).input("a.u", 1.0)
    result = scene.run()
    assert list(result["a.y"])[:4] == [1.0, 3.5, 6.0, 8.5]
    scene.input("a.gain", 1.0)
    with pytest.raises(CurveboundError, match=r"a\.gain is no input or tunable parameter"):
        scene.check()


def test_the_master_gives_what_fmpy_gives(mass_fmu):
    scene = Scene("same", stop_time=1.0, step=0.01)
    scene.add("one", mass_fmu, {"x_start": 1.0, "k": 30.0})
    scene.input("one.other", lambda t: np.sin(7.0 * t)).record("one.x", "one.v")
    own = scene.run()
    table = np.zeros(len(own.data), dtype=[("time", float), ("other", float)])
    table["time"] = own.time
    table["other"] = np.sin(7.0 * own.time)
    theirs = fmpy.simulate_fmu(
        str(mass_fmu),
        start_values={"x_start": 1.0, "k": 30.0},
        stop_time=1.0,
        output_interval=0.01,
        input=table,
        output=["x", "v"],
    )
    # fmpy hands on differences of times as steps, which differ from the step by rounding
    assert np.max(np.abs(theirs["x"] - own["one.x"])) < 1e-13


def test_components_share_what_is_put_in_one_row(mass_fmu):
    """Inputs of one component from several sources, and from the scene, are gathered."""
    scene = Scene("gathered", stop_time=0.1, step=0.01, algorithm="jacobi")
    for i in range(12):
        scene.add(f"m{i}", mass_fmu, {"x_start": float(i)})
        scene.record(f"m{i}.x")
    for i in range(12):
        scene.connect(f"m{i}.x", f"m{(5 * i + 1) % 12}.other", 1.0 + i, -0.5)
    with scene.prepare() as prepared:
        result = prepared.run()
        for i in range(12):
            target = (f"m{(5 * i + 1) % 12}", "other")
            place = prepared.exchange._inputs[target[0], "Real"][0]
            # the inputs of the last step are those of its beginning
            expected = (1.0 + i) * result[f"m{i}.x"][-2] - 0.5
            assert prepared.exchange.reals[place] == pytest.approx(expected, rel=1e-14)
