"""Formulas in the names of variables, as drawings are declared with: `frame.y - depth * cos(s)`.

A formula is kept as a tree of lists, ["+", left, right], that a page's script can evaluate too:
numbers, names of variables, and operations with their operands.
"""

from __future__ import annotations

import ast
import keyword
import math
import operator
import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias

from ..errors import CurveboundError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Floats", "Tree", "evaluate", "parse", "value_of", "variables_of"]

Floats: TypeAlias = "NDArray[np.float64]"
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

#: what can be drawn at any instant: operands, and numpy's name; the pages' formula.js knows them
_POINTWISE: dict[str, tuple[int, str]] = {
    "+": (2, "add"),
    "-": (2, "subtract"),
    "*": (2, "multiply"),
    "/": (2, "divide"),
    "**": (2, "power"),
    "negative": (1, "negative"),
    "abs": (1, "abs"),
    "sqrt": (1, "sqrt"),
    "sin": (1, "sin"),
    "cos": (1, "cos"),
    "tan": (1, "tan"),
    "sinh": (1, "sinh"),
    "cosh": (1, "cosh"),
    "tanh": (1, "tanh"),
    "exp": (1, "exp"),
    "log": (1, "log"),
    "atan2": (2, "arctan2"),
    "hypot": (2, "hypot"),
}

#: the same at one instant, by Python's own functions
_AT_ONCE: dict[str, Callable[..., float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "**": operator.pow,
    "negative": operator.neg,
    "abs": abs,
    **{name: getattr(math, name) for name in _POINTWISE if hasattr(math, name)},
}

#: what needs all samples: operands
_OVER_SAMPLES = {"first": 1, "median": 1}


@cache
def parse(text: str, *, samples: bool = False) -> Tree:
    """The tree of a formula in Python's notation.

    Known are + - * / **, numbers, pi, names with dots, and the functions abs, sqrt, sin, cos, tan,
    sinh, cosh, tanh, exp, log, atan2, hypot; with `samples` also first and median, over all samples
    of a result. Raises CurveboundError that names what is not understood.
    """
    known = {name: count for name, (count, _) in _POINTWISE.items()}
    known |= _OVER_SAMPLES if samples else {}
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
            return math.pi if name == "pi" else name
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            name = node.func.id
            if name in known and len(node.args) == known[name]:
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
    """A formula's values, of the common shape of `values`; KeyError where one lacks.

    `first` and `median` take the numbers among the samples of their operand.
    """
    if isinstance(tree, str):
        return values[tree]
    if not isinstance(tree, list):
        return tree
    import numpy as np  # a tenth of a second, which formulas that are only read need not pay

    operands = [np.asarray(evaluate(part, values), dtype=np.float64) for part in tree[1:]]
    if tree[0] in _OVER_SAMPLES:
        good = operands[0][np.isfinite(operands[0])]
        one = (good[0] if tree[0] == "first" else np.median(good)) if good.size else np.nan
        return np.full_like(operands[0], one)
    with np.errstate(all="ignore"):
        return getattr(np, _POINTWISE[tree[0]][1])(*operands)


def value_of(tree: Tree, known: Callable[[str], float]) -> float:
    """A formula's value at one instant, nan where it has none.

    `known` gives the value of a variable. Unlike `evaluate` it needs no numpy.
    """
    if isinstance(tree, str):
        return known(tree)
    if not isinstance(tree, list):
        return float(tree)
    operands = [value_of(part, known) for part in tree[1:]]
    if tree[0] in _OVER_SAMPLES:
        return operands[0]
    try:
        value = _AT_ONCE[tree[0]](*operands)
    except (ArithmeticError, ValueError):
        return math.nan
    return value if isinstance(value, float) else math.nan
