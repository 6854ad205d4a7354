"""Metrics: arithmetic on a run's outputs that ends in one number.

Read by a walk over Python's syntax tree, as simpleeval and asteval do it. These take a path with
dots for attributes of objects and learn of names while they evaluate; here paths and times are
known, and what is wrong is said, before the first run. numexpr evaluates text as Python's eval().
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from ...errors import CurveboundError

__all__ = ["Metric"]

_REDUCE: dict[str, Callable[[Any], Any]] = {
    "max": np.max,
    "min": np.min,
    "mean": np.mean,
    "rms": lambda x: np.sqrt(np.mean(np.square(x))),
    "std": np.std,
    "span": np.ptp,
    "first": lambda x: x[0],
    "final": lambda x: x[-1],
}
_EACH: dict[str, Callable[..., Any]] = {
    "abs": np.abs,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "log10": np.log10,
    "sin": np.sin,
    "cos": np.cos,
    "hypot": np.hypot,
    "atan2": np.arctan2,
}
_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_COMPARE: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_DEEPEST = 100  # levels of an expression
_NAMES = ", ".join([*_REDUCE, "at(x, t)", "when(condition)", *_EACH])


class Metric:
    """An expression such as `max(abs(plant.pendulum.angle))` or `final(bead.bead.x) - 1`.

    Names are outputs by path, or `time`. Functions of a whole run: max, min, mean, rms, std, span
    (largest less smallest), first, final, at(x, t) (at the time t, linear in between, NaN outside
    the run) and when(c) (first time at which c holds, NaN if never); of each sample: abs,
    sqrt, exp, log, log10, sin, cos, hypot, atan2. Operators + - * / ** and < <= > >=. Nothing else
    can be said in it: it is safe to take from anywhere.

    paths: the outputs that it uses.
    """

    def __init__(self, text: str) -> None:
        self.text = text.strip()
        self.paths: list[str] = []
        self._times: list[float] = []
        try:
            self._tree = ast.parse(self.text, mode="eval").body
            _require_flat(self._tree)
        except SyntaxError as error:
            raise CurveboundError(f"The metric {text!r} is no expression: {error.msg}.") from None
        except (RecursionError, MemoryError):  # what the parser raises depends on its version
            raise CurveboundError(
                f"The metric {text[:40]!r}... is nested too deeply: write it shorter."
            ) from None
        self._check(self._tree)
        if self._is_series(self._tree):
            raise CurveboundError(
                f"The metric {self.text!r} gives one number for each sample: wrap it in max(...), "
                "final(...) or another function of the whole run."
            )

    def __reduce__(self) -> Any:
        return (Metric, (self.text,))

    def _refuse(self, node: ast.AST) -> CurveboundError:
        return CurveboundError(
            f"The metric {self.text!r} may not contain {ast.unparse(node)!r}: use numbers, outputs "
            f"by path, time, + - * / ** < > and the functions {_NAMES}."
        )

    def _check(self, node: ast.AST) -> None:
        if isinstance(node, ast.Constant):
            if not isinstance(node.value, int | float) or isinstance(node.value, bool):
                raise self._refuse(node)
        elif isinstance(node, ast.Name | ast.Attribute):
            path = _path(node)
            if path is None or (path != "time" and "." not in path):
                raise self._refuse(node)
            if path != "time" and path not in self.paths:
                self.paths.append(path)
        elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
            self._check(node.left)
            self._check(node.right)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            self._check(node.operand)
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARE:
            self._check(node.left)
            self._check(node.comparators[0])
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            counts = {"at": 2, "when": 1, "hypot": 2, "atan2": 2}
            name = node.func.id
            known = name in _REDUCE or name in _EACH or name in counts
            if not known or len(node.args) != counts.get(name, 1):
                raise self._refuse(node)
            for argument in node.args:
                self._check(argument)
            if name == "at" and _is_constant(node.args[1]):
                with np.errstate(all="ignore"):
                    self._times.append(float(self._evaluate(node.args[1], None)))
        else:
            raise self._refuse(node)

    def _is_series(self, node: ast.AST) -> bool:
        """Whether a checked expression has one value per sample."""
        if isinstance(node, ast.Name | ast.Attribute):
            return True
        if isinstance(node, ast.Call):
            assert isinstance(node.func, ast.Name)
            name = node.func.id
            inner = node.args if name in _EACH else node.args[1:] if name == "at" else []
            return any(self._is_series(argument) for argument in inner)
        return any(self._is_series(part) for part in ast.iter_child_nodes(node))

    def require_within(self, start: float, stop: float) -> None:
        """CurveboundError where at(x, t) asks for a time (s) outside of a run's."""
        for time in self._times:
            if not _inside(time, start, stop):
                raise CurveboundError(
                    f"The metric {self.text!r} asks for t = {time:g} s, and the run lasts from "
                    f"{start:g} s to {stop:g} s."
                )

    def __call__(self, data: Any) -> float:
        """The number for a run's structured array."""
        with np.errstate(all="ignore"):
            return float(np.asarray(self._evaluate(self._tree, data)).reshape(-1)[0])

    def _evaluate(self, node: ast.AST, data: Any) -> Any:
        if isinstance(node, ast.Constant):
            return float(node.value)  # type: ignore[arg-type]
        if isinstance(node, ast.Name | ast.Attribute):
            return np.asarray(data[_path(node)], dtype=float)
        if isinstance(node, ast.BinOp):
            left, right = self._evaluate(node.left, data), self._evaluate(node.right, data)
            return _BINARY[type(node.op)](np.asarray(left), np.asarray(right))
        if isinstance(node, ast.UnaryOp):
            value = self._evaluate(node.operand, data)
            return -value if isinstance(node.op, ast.USub) else value
        if isinstance(node, ast.Compare):
            left = self._evaluate(node.left, data)
            return _COMPARE[type(node.ops[0])](left, self._evaluate(node.comparators[0], data))
        assert isinstance(node, ast.Call)
        assert isinstance(node.func, ast.Name)
        name = node.func.id
        values = [self._evaluate(argument, data) for argument in node.args]
        if name in _EACH:
            return _EACH[name](*values)
        time = np.asarray(data["time"], dtype=float)
        whole = np.broadcast_to(values[0], time.shape)
        if name in _REDUCE:
            return _REDUCE[name](whole)
        if name == "at":
            inside = _inside(values[1], time[0], time[-1])
            return np.where(inside, np.interp(values[1], time, whole), math.nan)
        hits = np.flatnonzero(whole)
        return time[hits[0]] if len(hits) else math.nan


def _inside(time: Any, start: float, stop: float) -> Any:
    """Whether times are a run's, rounding allowed for."""
    slack = 1e-9 * (stop - start)
    return (np.asarray(time) >= start - slack) & (np.asarray(time) <= stop + slack)


def _require_flat(tree: ast.AST) -> None:
    """RecursionError for what is nested deeper than walks over it by recursion can go."""
    level = [tree]
    for _ in range(_DEEPEST):
        level = [child for node in level for child in ast.iter_child_nodes(node)]
        if not level:
            return
    raise RecursionError


def _is_constant(node: ast.AST) -> bool:
    """Whether a checked expression is the same for all runs."""
    return not any(
        isinstance(part, ast.Attribute) or (isinstance(part, ast.Name) and part.id not in _EACH)
        for part in ast.walk(node)
    )


def _path(node: ast.AST) -> str | None:
    """The dotted name of a chain of attributes."""
    words = []
    while isinstance(node, ast.Attribute):
        words.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        return None
    return ".".join([node.id, *reversed(words)])
