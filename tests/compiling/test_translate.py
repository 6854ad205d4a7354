"""What is translated does what Python does: numbers, exceptions, arrays, classes across modules."""

from __future__ import annotations

import importlib
import math
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from curvebound.compiling.extension import compile_c, write_c
from curvebound.compiling.toolchain import HERE
from curvebound.compiling.translate import translate
from curvebound.errors import CurveboundError
from curvebound.fmi import runtime
from curvebound.fmi.compile import why_not
from curvebound.fmi.folder import Folder, systems_in
from curvebound.places import fmus_directory

pytestmark = pytest.mark.skipif(bool(why_not()), reason=f"not compiled: {why_not()}")

CORE = '''
from __future__ import annotations

import math
from typing import Annotated, Final

__all__ = [
    "AREA", "FACTOR", "SIDES", "WORDS", "Shape", "chosen", "power", "root", "scaled", "sine",
    "sum_of_areas", "total", "whole", "wound",
]

SIZE: Final = 3
FACTOR: Final = 2.5
AREA = FACTOR * FACTOR
WORDS = tuple(word.upper() for word in ("shape", "area"))
SIDES = {word: FACTOR * len(word) for word in WORDS}
_HIDDEN = (*WORDS, "hidden")
Row = Annotated[list[float], SIZE]
SHARES: Final[list[float]] = [0.5, 0.25, 0.125]


class Shape:
    def __init__(self) -> None:
        self.side: float = 1.0
        self.count: int = 0
        self.row: Row = [0.0] * SIZE
        self.bends: bool = False

    def area(self, short: float) -> float:
        """The area, as far as it is known here."""
        raise NotImplementedError

    def measure(self, short: float) -> float:
        self.count += 1
        return self.area(short)

    def divide(self, x: float) -> None:
        if x == 1.0:
            return
        self.side /= x


def add_areas(shape: Shape, short: float, count: int) -> float:
    bends = shape.bends
    result = 0.0
    for i in range(count):
        result += shape.area(short + i)
        if bends:
            shape.divide(2.0)
    return result


def sum_of_areas(shape: Shape, count: int) -> float:
    return add_areas(shape, 0.5, count)


def sine(x: float) -> float:
    return math.sin(x)


def root(x: float) -> float:
    return math.sqrt(x)


def power(x: float) -> float:
    return math.exp(x)


def chosen(x: float) -> float:
    return AREA * SIDES[_HIDDEN[1]] if x > 0.0 else len(_HIDDEN) * x


def whole(x: float) -> float:
    return float(math.floor(x))


def scaled(x: float) -> tuple[float, float]:
    return FACTOR * x, x / FACTOR


def filled(row: Row, x: float) -> None:
    for i in range(SIZE):
        row[i] = x * i


def total(x: float) -> float:
    row: Row = [0.0] * SIZE
    result = row[0] + row[1] + row[2]
    filled(row, x)
    for i in range(SIZE):
        result += row[i]
    return result


def wind(x: float, row: Row, start: int, bends: bool) -> None:
    """Set the elements from `start` on."""
    for i in range(start, SIZE):
        row[i] = share(row, i - SIZE, x) + row[0]
        if bends:
            row[i] -= 1.0


def share(row: Row, first: int, x: float) -> float:
    """A share of the row, in a circle, and of x."""
    return SHARES[2 - first % SIZE] * row[first] + SHARES[1] * row[first + 1] / x


def three(x: float) -> tuple[float, float, float]:
    return x, 3.0 * x, x * x


def wound(x: float) -> float:
    row: Row = [0.0] * SIZE
    row[0:3] = three(x)
    wind(x, row, 1, x > 2.0)
    return added(*row) + share(row, 0, 2.0 * x)


def added(x: float, y: float, z: float) -> float:
    return x + y - z
'''

SYSTEM = """
from __future__ import annotations

from .core_of_test import FACTOR, Shape

__all__ = ["square"]


class Square(Shape):
    def area(self, short: float) -> float:
        return self.side * short * FACTOR

    def divide(self, x: float) -> None:
        super().divide(x)
        self.side += 1.0


def square() -> Shape:
    return Square()
"""

VISIBLE = {
    "": ("chosen", "power", "root", "scaled", "sine", "sum_of_areas", "total", "whole", "wound"),
    "Shape": ("side", "bends", "count", "measure", "divide"),
}


@pytest.fixture(scope="module")
def forms(tmp_path_factory) -> Iterator[list[tuple[ModuleType, ModuleType]]]:
    """Core and system, interpreted and compiled."""
    folder: Path = tmp_path_factory.mktemp("forms")
    package = folder / "package_of_test"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "core_of_test.py").write_text(CORE)
    (package / "system_of_test.py").write_text(SYSTEM)
    sys.path.insert(0, str(folder))
    try:
        names = ("package_of_test.core_of_test", "package_of_test.system_of_test")
        repeated = {names[0]: ["add_areas"]}
        written_out = {names[0]: ["wind", "share"]}
        core = translate(
            "compiled_core_of_test", {names[0]: CORE}, None, VISIBLE, repeated, written_out
        )
        system = translate("compiled_system_of_test", {names[1]: SYSTEM}, core)
        for unit in (core, system):
            compile_c(write_c(unit, folder, core), HERE)
        importlib.invalidate_caches()
        yield [
            tuple(importlib.import_module(name) for name in names),  # type: ignore[misc]
            (importlib.import_module(core.name), importlib.import_module(system.name)),
        ]
    finally:
        sys.path.remove(str(folder))


def outcome(function, x: float) -> object:
    try:
        return function(x)
    except (ArithmeticError, ValueError) as error:
        return type(error)


@pytest.mark.parametrize("name", [name for name in VISIBLE[""] if name != "sum_of_areas"])
def test_same_numbers_and_exceptions(forms, name: str) -> None:
    (plain, _), (compiled, _) = forms
    for x in (0.0, -0.0, 0.3, -2.5, 1e9, 709.0, 1e300, math.inf, -math.inf):
        want = outcome(getattr(plain, name), x)
        assert repr(outcome(getattr(compiled, name), x)) == repr(want), x
    assert math.isnan(compiled.sine(math.nan))


def test_public_constants(forms) -> None:
    (plain, _), (compiled, _) = forms
    for core in (plain, compiled):
        assert (core.FACTOR, core.AREA, core.WORDS) == (2.5, 6.25, ("SHAPE", "AREA"))
        assert core.SIDES == {"SHAPE": 12.5, "AREA": 10.0}
    assert not hasattr(compiled, "SIZE")
    assert not hasattr(compiled, "_HIDDEN")


def test_classes_across_modules(forms) -> None:
    results = []
    for _, system in forms:
        shape = system.square()
        shape.divide(4.0)
        shape.divide(1.0)
        results.append((shape.measure(0.5), shape.measure(2.0), shape.side, shape.count))
        with pytest.raises(ZeroDivisionError):
            shape.divide(0.0)
    assert results[0] == results[1] == (2.8125, 11.25, 2.25, 2)


@pytest.mark.parametrize("bends", [False, True])
def test_a_loop_that_each_class_has_for_itself(forms, bends: bool) -> None:
    results = []
    for core, system in forms:
        shape = system.square()
        shape.bends = bends
        results.append((core.sum_of_areas(shape, 3), shape.side))
    assert results[0] == results[1] == ((17.8125, 1.875) if bends else (11.25, 1.0))


def test_what_that_loop_calls_is_called_directly(tmp_path, monkeypatch) -> None:
    package = tmp_path / "direct_of_test"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "core_of_test.py").write_text(CORE)
    (package / "system_of_test.py").write_text(SYSTEM)
    monkeypatch.syspath_prepend(tmp_path)
    names = ("direct_of_test.core_of_test", "direct_of_test.system_of_test")
    core = translate("core", {names[0]: CORE}, None, VISIBLE, {names[0]: ["add_areas"]})
    system = translate("system", {names[1]: SYSTEM}, core)
    assert "Square.c_area(self, short_ + i)" in system.pyx
    made = write_c(system, tmp_path, core).read_text()
    assert re.search(r"static CYTHON_INLINE double \w+Square_c_area\(", made)
    assert not re.search(r"static CYTHON_INLINE int \w+Square_c_divide\(", made)


def test_what_cannot_be_translated_is_said(tmp_path, monkeypatch) -> None:
    text = "class A:\n    @property\n    def x(self) -> float:\n        return 1.0\n"
    (tmp_path / "decorated_of_test.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(CurveboundError, match=r"decorated_of_test, line \d+: x: no decorators"):
        translate("compiled_of_test", {"decorated_of_test": text})


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("fill(row, x)", "the bounds of a loop .* have to be known"),
        ("fill(row, 2)\n    other(row)", "f: the array row is used as a whole"),
        ("y = 2.0 * twice(2.0 * x)", "twice .* uses x more than once: pass it a name"),
        ("y = fill(row, 2)", "fill is more than one return"),
    ],
)
def test_what_cannot_be_written_out_is_said(tmp_path, monkeypatch, body: str, message: str) -> None:
    text = (
        "from typing import Annotated\nRow = Annotated[list[float], 2]\n\n\n"
        f"def f(x: int) -> None:\n    row: Row = [0.0] * 2\n    {body}\n\n\n"
        "def other(row: Row) -> None:\n    row[0] = 1.0\n\n\n"
        "def twice(x: float) -> float:\n    'Of x.'\n    return x + x\n\n\n"
        "def fill(row: Row, count: int) -> None:\n    'Fill.'\n"
        "    for i in range(count):\n        row[i] = 1.0\n"
    )
    (tmp_path / "written_out_of_test.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "written_out_of_test", raising=False)
    written_out = {"written_out_of_test": ["fill", "twice"]}
    with pytest.raises(CurveboundError, match=message):
        translate("compiled_of_test", {"written_out_of_test": text}, None, None, None, written_out)


def test_functions_of_another_module_are_written_out(tmp_path, monkeypatch) -> None:
    """With the constants that these know; one's own come before them."""
    rows = (
        "from typing import Annotated, Final\n\nSIZE: Final = 2\n"
        "Row = Annotated[list[float], SIZE]\n"
        "FACTORS: Final[list[float]] = [3.0, 7.0]\n\n\n"
        "def fill(row: Row, x: float) -> None:\n    'Fill.'\n"
        "    for i in range(SIZE):\n        row[i] = part(i, x)\n\n\n"
        "def part(i: int, x: float) -> float:\n    'One.'\n    return FACTORS[i] * x\n\n\n"
        "def end(row: Row) -> float:\n    'Its own.'\n    return row[0]\n"
    )
    use = (
        "from .rows_of_test import SIZE, Row, fill\n\n\n"
        "def f(x: float) -> float:\n    row: Row = [0.0] * SIZE\n    fill(row, x)\n"
        "    return end(row)\n\n\n"
        "def end(row: Row) -> float:\n    'The last.'\n    return row[1]\n"
    )
    package = tmp_path / "written_of_test"
    package.mkdir()
    texts = {"rows_of_test": rows, "use_of_test": use}
    (package / "__init__.py").write_text("")
    for name, text in texts.items():
        (package / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    sources = {f"written_of_test.{name}": text for name, text in texts.items()}
    written_out = {
        "written_of_test.rows_of_test": ["fill", "part", "end"],
        "written_of_test.use_of_test": ["end"],
    }
    made = translate("compiled_of_test", sources, None, None, None, written_out).pyx
    assert "row_0 = 3.0 * x" in made
    assert "row_1 = 7.0 * x" in made
    assert "return row_1" in made
    assert "fill" not in made
    assert "part" not in made


def test_a_variable_that_lacks_its_type_is_named(tmp_path, monkeypatch) -> None:
    text = (
        "class A:\n    def __init__(self) -> None:\n        self.x: float = 1.0\n\n\n"
        "def first(all: list[A]) -> float:\n    a = all[0]\n    return a.x\n"
    )
    (tmp_path / "untyped_of_test.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    unit = translate("compiled_of_test", {"untyped_of_test": text})
    with pytest.raises(CurveboundError, match="annotate the variables of which x is used"):
        write_c(unit, tmp_path, unit)


@pytest.mark.parametrize("folder", systems_in(fmus_directory()), ids=lambda folder: folder.name)
def test_no_system_calls_python_functions_for_numbers(folder: Folder) -> None:
    """A call of `math`'s own costs as much as the sine and the cosine that it is for."""
    core = runtime.runtime()
    told = runtime.VISIBLE, runtime.REPEATED, runtime.WRITTEN_OUT
    known = translate(core.extension, core.kernel, None, *told)
    own = runtime.system_sources(folder, core)
    text = translate(own.extension, own.kernel, known).pyx
    assert set(re.findall(r"\bmath\.(\w+)\(", text)) == set()
