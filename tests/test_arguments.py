"""Words of the command line: what is taken, and what is wrong usage."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from curvebound.arguments import file_of, positive, setting, whole


@pytest.mark.parametrize(
    ("parse", "taken"),
    [
        (positive, {"1e-300": 1e-300, "2": 2.0, " 0.5 ": 0.5}),
        (whole(1), {"1": 1, "12": 12}),
        (whole(0), {"0": 0}),
        (file_of(".csv"), {"a/b.csv": Path("a/b.csv"), "A.CSV": Path("A.CSV")}),
        (file_of(".csv", ".npz"), {"a.csv": Path("a.csv"), "a.npz": Path("a.npz")}),
        (setting, {"a.b=1": ("a.b", "1"), " a = b=c ": ("a", "b=c"), "a=": ("a", "")}),
    ],
)
def test_what_makes_sense_is_taken(parse: Callable[[str], Any], taken: dict[str, Any]) -> None:
    assert {text: parse(text) for text in taken} == taken


@pytest.mark.parametrize(
    ("parse", "refused"),
    [
        (positive, ["0", "-0.0", "-1", "inf", "nan", "two", ""]),
        (whole(1), ["0", "-3", "1.0", "", "one"]),
        (whole(0), ["-1", "x"]),
        (file_of(".csv"), ["a.txt", "csv", "a.csv.gz"]),
        (file_of(".csv", ".npz"), ["a.json", "a.npzz"]),
        (setting, ["a.b", "=1", " =1", ""]),
    ],
)
def test_what_makes_none_is_refused(parse: Callable[[str], Any], refused: list[str]) -> None:
    for text in refused:
        with pytest.raises(argparse.ArgumentTypeError):
            parse(text)
