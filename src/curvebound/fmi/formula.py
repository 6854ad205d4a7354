"""Formulas in the names of variables, as drawings are declared with: `frame.y - depth * cos(s)`.

A formula is kept as a tree of lists, ["+", left, right], that a page's script can evaluate too:
numbers, names of variables, and operations with their operands.
"""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CurveboundError

__all__ = ["Floats", "Tree", "evaluate", "parse", "variables_of"]

Floats = NDArray[np.float64]
#: a number, the name of a variable, or [operation, operand, ...]
Tree = Any

#: Python's own words may be parts of names (wave.lambda), which ast does not read
_WORD = re.compile(rf"\b({'|'.join(keyword.kwlist)})\b")
_WRITTEN = re.compile(rf"\b({'|'.join(keyword.kwlist)})_word\b")
_SIGNS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Pow: "**",
}

#: what can be drawn at any instant; the pages' formula.js knows the same
_POINTWISE: dict[str, tuple[int, Callable[..., Any]]] = {
    "+": (2, np.add),
    "-": (2, np.subtract),
    "*": (2, np.multiply),
    "/": (2, np.divide),
    "**": (2, np.power),
    "negative": (1, np.negative),
    "abs": (1, np.abs),
    "sqrt": (1, np.sqrt),
    "sin": (1, np.sin),
    "cos": (1, np.cos),
    "tan": (1, np.tan),
    "sinh": (1, np.sinh),
    "cosh": (1, np.cosh),
    "tanh": (1, np.tanh),
    "exp": (1, np.exp),
    "log": (1, np.log),
    "atan2": (2, np.arctan2),
    "hypot": (2, np.hypot),
}


def _first(values: Floats) -> Floats:
    """The first number in `values`, everywhere."""
    good = values[np.isfinite(values)]
    return np.full_like(values, good[0] if good.size else np.nan)


def _median(values: Floats) -> Floats:
    """The median of the numbers in `values`, everywhere."""
    good = values[np.isfinite(values)]
    return np.full_like(values, np.median(good) if good.size else np.nan)


#: what needs all samples
_OVER_SAMPLES: dict[str, tuple[int, Callable[..., Any]]] = {
    "first": (1, _first),
    "median": (1, _median),
}


def parse(text: str, *, samples: bool = False) -> Tree:
    """The tree of a formula in Python's notation.

    Known are + - * / **, numbers, pi, names with dots, and the functions abs, sqrt, sin, cos, tan,
    sinh, cosh, tanh, exp, log, atan2, hypot; with `samples` also first and median, over all samples
    of a result. Raises CurveboundError that names what is not understood.
    """
    known = {**_POINTWISE, **(_OVER_SAMPLES if samples else {})}
    try:
        root = ast.parse(_WORD.sub(r"\1_word", text.strip()), mode="eval").body
    except SyntaxError as error:
        raise CurveboundError(f"{text!r} is no formula: {error.msg}") from error

    def written(node: ast.expr) -> str:
        return _WRITTEN.sub(r"\1", ast.unparse(node))

    def tree(node: ast.expr) -> Tree:
        if isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            return float(node.value)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            inner = tree(node.operand)
            return inner if isinstance(node.op, ast.UAdd) else ["negative", inner]
        if isinstance(node, ast.BinOp) and type(node.op) in _SIGNS:
            return [_SIGNS[type(node.op)], tree(node.left), tree(node.right)]
        if isinstance(node, ast.Name | ast.Attribute):
            name = written(node)
            return float(np.pi) if name == "pi" else name
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            name = node.func.id
            if name in known and len(node.args) == known[name][0]:
                return [name, *map(tree, node.args)]
        raise CurveboundError(
            f"{written(node)!r} in the formula {text!r} is not understood: use names of "
            "variables, numbers, + - * / ** and "
            + ", ".join(name for name in known if name.isalnum() and name != "negative")
        )

    return tree(root)


def variables_of(tree: Tree) -> set[str]:
    """The names of the variables in a formula's tree."""
    if isinstance(tree, str):
        return {tree}
    return set().union(*map(variables_of, tree[1:])) if isinstance(tree, list) else set()


def evaluate(tree: Tree, values: Mapping[str, Floats | float]) -> Any:
    """A formula's values, of the common shape of `values`; KeyError where one lacks."""
    if isinstance(tree, str):
        return values[tree]
    if not isinstance(tree, list):
        return tree
    operands = [evaluate(part, values) for part in tree[1:]]
    _, function = {**_POINTWISE, **_OVER_SAMPLES}[tree[0]]
    with np.errstate(all="ignore"):
        return function(*(np.asarray(operand, dtype=np.float64) for operand in operands))
