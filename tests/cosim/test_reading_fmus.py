"""What is read of an FMU's description: everything, of one that gives it all and of a bare one."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from descriptions import BARE, FULL, packed

from curvebound.cosim.fmu import Variable, read_fmu


def test_all_that_a_description_gives(tmp_path: Path) -> None:
    fmu = packed(FULL, tmp_path / "all.fmu")
    speed = (0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.0)
    celsius = (0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 273.15)
    other = {"unit": None, "dimension": None, "nominal": None, "minimum": None, "maximum": None}
    other |= {"items": None, "description": "", "start": None}

    def variable(name: str, reference: int, kind: str, what: str, **more: object) -> Variable:
        causality, variability, initial = what.split()
        return Variable(  # type: ignore[arg-type]
            name, reference, kind, causality, variability,
            **{"initial": initial, **other, **more},
        )  # fmt: skip

    expected = [
        variable("a", 7, "Real", "input continuous exact", unit="km/h", dimension=speed,
                 start="1.5", nominal=30.0, minimum="-1", maximum="2", description="the first"),
        variable("b", 3, "Real", "input continuous exact", unit="degC", dimension=celsius,
                 start="2", nominal=4.0, minimum="-5", maximum="6"),
        variable("p", 4, "Integer", "parameter tunable exact", start="5", minimum="1",
                 maximum="9"),
        variable("e", 4, "Integer", "parameter fixed exact", start="3",
                 items={"on": 3, "off": -7}),
        variable("x", 1, "Real", "output continuous calculated"),
        variable("y", 2, "Real", "output continuous exact", unit="none", start="0"),
        variable("z", 5, "Boolean", "output continuous calculated"),
        variable("c", 6, "Real", "local constant exact", start="8"),
        variable("q", 9, "String", "local continuous calculated"),
        variable("o", 8, "Integer", "output continuous calculated", items={"on": 3, "off": -7}),
        variable("w", 10, "Real", "output continuous calculated", unit="degC",
                 dimension=celsius),
        variable("s", 11, "String", "parameter fixed exact", start="k"),
        variable("f", 12, "Boolean", "parameter fixed exact", start="true"),
    ]  # fmt: skip
    found = list(fmu.variables.values())
    assert [v.name for v in found] == list(fmu.variables)
    for one, other_one in zip(found, expected, strict=True):
        assert vars(one) == vars(other_one)
    assert {n for n, v in fmu.variables.items() if v.is_settable_start} == set("abpeysf")
    assert {n for n, v in fmu.variables.items() if v.is_drivable} == set("abp")
    assert {k: v for k, v in vars(fmu).items() if k != "variables"} == {
        "path": tmp_path / "all.fmu", "model_name": "All", "description": "All there is",
        "identifier": "all", "guid": "{g}",
        "dependencies": {"x": ("b",), "y": (), **dict.fromkeys("zow", ("a", "b"))},
        "undeclared": frozenset("zow"),
        "initial_dependencies": {"x": ("a",), "y": (), **dict.fromkeys("zow", ("a", "b"))},
        "can_roll_back": True, "can_serialize": True, "can_vary_step": True, "takes_slopes": True,
        "keeps_inputs": False, "gives_rates": True, "gives_changes": True,
        "only_once_per_process": True,
        "start_time": 0.5, "stop_time": 2.5, "step": 0.125, "tolerance": 1e-7, "drawing": None,
    }  # fmt: skip
    assert (fmu.inputs, fmu.outputs) == (["a", "b"], ["x", "y", "z", "o", "w"])


def test_what_is_not_given_is_what_the_standard_has_for_it(tmp_path: Path) -> None:
    fmu = packed(BARE, tmp_path / "bare.fmu")
    assert {k: v for k, v in vars(fmu).items() if k not in ("variables", "path")} == {
        "model_name": "Bare", "description": "", "identifier": "bare", "guid": "0",
        "dependencies": {"y": ("u",)}, "undeclared": frozenset("y"),
        "initial_dependencies": {"y": ("u",)},
        "can_roll_back": False, "can_serialize": False, "can_vary_step": False,
        "takes_slopes": False, "keeps_inputs": False, "gives_rates": False, "gives_changes": False,
        "only_once_per_process": False,
        "start_time": None, "stop_time": None, "step": None, "tolerance": None, "drawing": None,
    }  # fmt: skip
    assert read_fmu(tmp_path / "bare.fmu") is fmu


@pytest.mark.parametrize(
    ("name", "given", "value"),
    [
        ("a", "1.5 km/h", 1.5), ("a", "-inf", -math.inf), ("a", 3, 3.0), ("a", "x", None),
        ("a", None, None), ("p", " 7 ", 7), ("p", 2147483647, 2147483647), ("p", -(2**31), None),
        ("p", 2**31, None), ("p", 1.5, None), ("e", "on", 3), ("e", " off ", -7), ("e", "3", 3),
        ("e", 3.0, 3), ("e", 4, None), ("e", "up", None), ("e", None, None), ("z", "TRUE", True),
        ("z", "1", True), ("z", "0", False), ("z", "False", False), ("z", "2", None),
        ("z", 1, True), ("z", 0, False), ("q", 5, "5"), ("q", " k ", " k "),
    ],
)  # fmt: skip
def test_a_value_as_the_variable_takes_it(
    name: str, given: object, value: object, tmp_path: Path
) -> None:
    variable = packed(FULL, tmp_path / "all.fmu").variables[name]
    if value is None:
        with pytest.raises(ValueError, match=r"is not|not "):
            variable.value(given)  # type: ignore[arg-type]
    else:
        found = variable.value(given)  # type: ignore[arg-type]
        assert (found, type(found)) == (value, type(value))
