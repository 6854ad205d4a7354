"""Whole texts, pages and pictures are what they were, word for word and number for number.

    CURVEBOUND_FINGERPRINTS=write python -m pytest ...      writes what the tests find

Other tests say what must be in a text, or what a figure shows. These see any change of it. Who
changes one on purpose looks at the text (a test that fails says where it is) and writes anew.
Kept is a digest of the words and, of the numbers, how many there are and a weighted sum: another C
library may round a coordinate in another way, which changes it by less than TOLERANCE.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

__all__ = ["as_text", "assert_same"]

FILE = Path(__file__).with_suffix(".json")
TOLERANCE = 0.3
_NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.]*\w)|-?\b\d+\.\d+")
#: what changes with the sources, or with other packages, and not with the text
_CHANGING = re.compile(
    r"\{[0-9a-f-]{36}\}|\b[0-9a-f]{12,}\b|\d{4}-\d\d-\d\dT[\d:.+Z]+|PythonFMU [\w.]+"
)


def fingerprint(text: str) -> dict[str, Any]:
    """Digest of the words; count and weighted sum of the numbers."""
    text = _CHANGING.sub("", text)
    numbers = [float(one) for one in _NUMBER.findall(text)]
    words = hashlib.sha256(_NUMBER.sub("#", text).encode()).hexdigest()[:16]
    finite = [x for x in numbers if math.isfinite(x)]
    total = math.fsum(x * (0.5 + (7 * i % 101) / 101) for i, x in enumerate(finite))
    return {"words": words, "count": len(numbers), "sum": float(f"{total:.10g}")}


def assert_same(name: str, text: str) -> None:
    """Assert that what is called `name` is as it was."""
    kept = json.loads(FILE.read_text(encoding="utf-8")) if FILE.is_file() else {}
    found = fingerprint(text)
    if os.environ.get("CURVEBOUND_FINGERPRINTS") == "write":
        kept[name] = found
        lines = [f"{json.dumps(key)}: {json.dumps(kept[key])}" for key in sorted(kept)]
        FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
        return
    before = kept[name]
    same = (found["words"], found["count"]) == (before["words"], before["count"])
    if same and math.isclose(found["sum"], before["sum"], rel_tol=1e-9, abs_tol=TOLERANCE):
        return
    with tempfile.NamedTemporaryFile("w", suffix=".txt", delete=False, encoding="utf-8") as file:
        file.write(text)
    raise AssertionError(
        f"{name} has changed: {found}, {before} before. If {file.name} is as it should be, run "
        "this test with CURVEBOUND_FINGERPRINTS=write and commit tests/fingerprints.json"
    )


def as_text(value: Any) -> str:
    """Data, or a figure of matplotlib with all that is drawn in it, as text."""
    return "\n".join(_lines(value))


def _lines(value: Any, place: str = "") -> Iterator[str]:
    if hasattr(value, "get_axes") and hasattr(value, "get_size_inches"):
        yield from _figure(value)
    elif isinstance(value, dict):
        for key, one in value.items():
            yield from _lines(one, f"{place}.{key}")
    elif isinstance(value, list | tuple):
        if value and all(isinstance(x, int | float) for x in value):
            yield f"{place} " + " ".join(_number(x) for x in value)
            return
        yield f"{place} of {len(value)}"
        for i, one in enumerate(value):
            yield from _lines(one, f"{place}.{i}")
    elif hasattr(value, "tolist"):
        yield from _lines(value.tolist(), place)
    elif hasattr(value, "__dict__") and not isinstance(value, type):
        yield from _lines(vars(value), f"{place} {type(value).__name__}")
    else:
        yield f"{place} {_number(value) if isinstance(value, float) else value}"


def _number(x: float) -> str:
    return f"{x:.6g}" if isinstance(x, float) else str(x)


def _flat(array: Any) -> list[float]:
    """Numbers of an array, what is masked as NaN."""
    filled = array.filled(math.nan) if hasattr(array, "filled") else array
    return [float(x) for x in filled.ravel()]


def _figure(figure: Any) -> Iterator[str]:
    yield f"figure {figure.get_size_inches().tolist()} {[t.get_text() for t in figure.texts]}"
    for axes in figure.get_axes():
        names = [axes.get_title(), axes.get_xlabel(), axes.get_ylabel()]
        yield f"axes {names} {axes.get_xscale()} {axes.get_yscale()} {axes.axison}"
        yield from _lines([*map(float, (*axes.get_xlim(), *axes.get_ylim()))], "limits")
        for axis in (axes.xaxis, axes.yaxis):
            at = [float(x) for x in axis.get_majorticklocs()]
            yield f"ticks {axis.get_major_formatter().format_ticks(at)}"
            yield from _lines(at, "at")
        for artist in axes.get_children():
            yield from _artist(artist)
        if axes.get_legend() is not None:
            yield f"legend {[t.get_text() for t in axes.get_legend().get_texts()]}"
    for legend in figure.legends:
        yield f"legend {[t.get_text() for t in legend.get_texts()]}"


def _artist(artist: Any) -> Iterator[str]:
    kind = type(artist).__name__
    if not artist.get_visible():
        return
    if kind == "Line2D":
        style = (artist.get_color(), artist.get_linestyle(), artist.get_marker())
        sizes = (artist.get_linewidth(), artist.get_zorder(), artist.get_alpha())
        yield f"line {style} {sizes} {artist.get_label()}"
        yield from _lines([float(x) for x in artist.get_xdata()], "x")
        yield from _lines([float(y) for y in artist.get_ydata()], "y")
    elif kind in ("Text", "Annotation") and artist.get_text():
        yield f"text {artist.get_text()} {artist.get_color()} {artist.get_size()}"
        yield from _lines([float(x) for x in artist.get_position()], "at")
    elif hasattr(artist, "get_path") and kind not in ("Spine",) and kind != "Rectangle":
        yield f"{kind} {artist.get_facecolor()} {artist.get_linewidth()} {artist.get_zorder()}"
        for row in artist.get_path().vertices.tolist():
            yield from _lines([float(x) for x in row], "point")
    elif hasattr(artist, "get_offsets") and hasattr(artist, "get_paths"):
        yield f"{kind} {artist.get_zorder()}"
        yield from _lines(_flat(artist.get_offsets()), "offsets")
        array = artist.get_array()
        if array is not None:
            yield from _lines(_flat(array), "values")
    elif hasattr(artist, "get_array") and artist.get_array() is not None:
        yield f"{kind} {artist.get_zorder()}"
        yield from _lines(_flat(artist.get_array()), "values")
