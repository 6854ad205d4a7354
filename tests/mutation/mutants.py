"""Small faults to put into a source: Python by its syntax tree, C and JavaScript by their tokens.

Each mutant is one edit of one place: a sign, an operator, a comparison, a constant, a wrong
variable or a statement left out. What no test can be asked to see is left alone: docstrings,
messages, annotations, imports, static checks and names that are exported.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Mutant", "mutants_of"]


@dataclass(frozen=True)
class Mutant:
    """An edit of one file: characters `begin` to `end`, on line `line` from 1, become `new`."""

    file: str
    line: int
    begin: int
    end: int
    old: str
    new: str
    #: what stands on the line
    shown: str

    def applied(self, text: str) -> str:
        """`text`, the file's content, with the fault in it."""
        assert text[self.begin : self.end] == self.old
        return text[: self.begin] + self.new + text[self.end :]

    def __str__(self) -> str:
        old, new = (" ".join(part.split()) for part in (self.old, self.new))
        change = f"{old[:40]} -> {new[:40] or 'nothing'}"
        return f"{self.file}:{self.line}: {change}   in: {self.shown[:90]}"


def mutants_of(file: str, text: str, draw: random.Random) -> list[Mutant]:
    """All places of a source that can be mutated, one mutant for each; `draw` chooses its kind."""
    edits = _python if Path(file).suffix == ".py" else _tokens
    lines = text.splitlines()

    def mutant(begin: int, end: int, new: str) -> Mutant:
        line = text.count("\n", 0, begin) + 1
        return Mutant(file, line, begin, end, text[begin:end], new, lines[line - 1].strip())

    return [
        mutant(begin, end, new) for begin, end, new in edits(text, draw) if text[begin:end] != new
    ]


Edit = tuple[int, int, str]

_COMPARE = {
    ast.Lt: ("<=", ">="), ast.LtE: ("<", ">"), ast.Gt: (">=", "<="), ast.GtE: (">", "<"),
    ast.Eq: ("!=",), ast.NotEq: ("==",), ast.Is: ("is not",), ast.IsNot: ("is",),
    ast.In: ("not in",), ast.NotIn: ("in",),
}  # fmt: skip
_BINARY = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"),
    ast.Mod: ("%", "*"), ast.Pow: ("**", "*"), ast.FloorDiv: ("//", "*"),
}  # fmt: skip


class _Places(ast.NodeVisitor):
    """Collects the edits of a module."""

    def __init__(self, text: str, draw: random.Random) -> None:
        self.text = text
        self.draw = draw
        self.edits: list[Edit] = []
        self.names: list[str] = []
        lines = text.splitlines(keepends=True)
        self.lines = lines
        self.starts = [0]
        for line in lines:
            self.starts.append(self.starts[-1] + len(line))

    def at(self, line: int, column: int) -> int:
        """Characters before a place that the syntax tree gives in bytes."""
        return self.starts[line - 1] + len(self.lines[line - 1].encode()[:column].decode())

    def span(self, node: ast.AST) -> tuple[int, int]:
        return (
            self.at(node.lineno, node.col_offset),  # type: ignore[attr-defined]
            self.at(node.end_lineno, node.end_col_offset),  # type: ignore[attr-defined]
        )

    def replace(self, node: ast.AST, new: str) -> None:
        self.edits.append((*self.span(node), new))

    def between(self, left: ast.AST, right: ast.AST, old: str, new: str) -> None:
        """Replace the operator `old` that stands between two expressions."""
        begin, end = self.span(left)[1], self.span(right)[0]
        found = re.search(re.escape(old).replace(r"\ ", r"\s+"), self.text[begin:end])
        if found:
            self.edits.append((begin + found.start(), begin + found.end(), new))

    def visit_Compare(self, node: ast.Compare) -> None:
        left = node.left
        for operator, right in zip(node.ops, node.comparators, strict=True):
            old = _SIGN[type(operator)]
            self.between(left, right, old, self.draw.choice(_COMPARE[type(operator)]))
            left = right
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        text = isinstance(node.left, ast.Constant | ast.JoinedStr) and not _is_number(node.left)
        text |= isinstance(node.right, ast.Constant | ast.JoinedStr) and not _is_number(node.right)
        if type(node.op) in _BINARY and not text:
            self.between(node.left, node.right, *_BINARY[type(node.op)])
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        swap = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        self.between(node.values[0], node.values[1], *swap)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not | ast.USub):
            begin = self.span(node)[0]
            self.edits.append((begin, begin + (3 if isinstance(node.op, ast.Not) else 1), ""))
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self.replace(node, str(not value))
        elif isinstance(value, int):
            self.replace(node, str(self.draw.choice((value + 1, value + 1, 2 * value + 2))))
        elif isinstance(value, float):
            other = self.draw.choice((10.0 * value, 0.5 * value, 1.05 * value)) or 1.0
            self.replace(node, repr(other))

    def visit_Name(self, node: ast.Name) -> None:
        if isinstance(node.ctx, ast.Load) and node.id in self.names and self.draw.random() < 0.3:
            others = [name for name in self.names if name != node.id]
            if others:
                self.replace(node, self.draw.choice(others))

    def visit_If(self, node: ast.If) -> None:
        if not _is_static(node.test):
            self.replace(node.test, self.draw.choice(("True", "False")))
            self.generic_visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        before = self.names
        given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
        stored = [n.id for n in ast.walk(node) if isinstance(n, ast.Name) and _stores(n)]
        self.names = [n for n in dict.fromkeys([*(a.arg for a in given), *stored]) if n != "self"]
        for value in [*node.args.defaults, *node.args.kw_defaults]:
            if value is not None:
                self.visit(value)
        for statement in node.body:
            self.visit(statement)
        self.names = before

    visit_AsyncFunctionDef = visit_FunctionDef  # type: ignore[assignment]

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_Assign(self, node: ast.Assign) -> None:
        target = node.targets[0]
        if isinstance(target, ast.Name) and target.id.startswith("__"):
            return
        if not isinstance(target, ast.Name) or not self.names:
            self.drop(node, isinstance(target, ast.Attribute | ast.Subscript))
        self.visit(node.value)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self.drop(node)
        if type(node.op) in _BINARY:
            old, new = _BINARY[type(node.op)]
            self.between(node.target, node.value, f"{old}=", f"{new}=")
        self.visit(node.value)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call):
            self.drop(node)
        if not isinstance(node.value, ast.Constant):
            self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_Break(self, node: ast.Break) -> None:
        self.replace(node, "pass")

    def visit_Continue(self, node: ast.Continue) -> None:
        self.replace(node, "pass")

    def drop(self, node: ast.stmt, wanted: bool = True) -> None:
        if wanted:
            self.replace(node, "pass")

    def nothing(self, node: ast.AST) -> None:
        """Left alone: messages, imports, static checks."""

    visit_Raise = visit_Assert = visit_Import = visit_ImportFrom = nothing
    visit_JoinedStr = nothing


_SIGN = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.Is: "is", ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
}  # fmt: skip


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def _is_static(test: ast.AST) -> bool:
    words = {"TYPE_CHECKING", "__name__"}
    return any(isinstance(n, ast.Name) and n.id in words for n in ast.walk(test))


def _stores(name: ast.Name) -> bool:
    return isinstance(name.ctx, ast.Store)


def _python(text: str, draw: random.Random) -> Iterator[Edit]:
    places = _Places(text, draw)
    places.visit(ast.parse(text))
    yield from sorted(set(places.edits))


# -- C and JavaScript -----------------------------------------------------------------------------

#: what is skipped as a whole: comments, strings, templates, lines of the preprocessor
_SKIPPED = "|".join(
    (
        r"/\*.*?\*/",
        r"//[^\n]*",
        r'"(?:\\.|[^"\\\n])*"',
        r"'(?:\\.|[^'\\\n])*'",
        r"`(?:\\.|[^`\\])*`",
        r"^#(?:\\\n|[^\n])*",
    )
)
_TOKEN = re.compile(
    rf"(?P<skip>{_SKIPPED})"
    r"|(?P<number>(?<![\w.])\d+(?:\.\d+)?(?:[eE][+-]?\d+)?(?![\w.]))"
    r"|(?P<operator>===|!==|<<=|>>=|=>|->|\+\+|--|&&|\|\||[<>=!]=|[+\-*/%&|^]=|<<|>>|(?<=\s)[-+*/<>](?=\s)|!(?=[\w(]))"
    r"|(?P<statement>^[ \t]+(?:[\w.\[\]>-]+(?:\([^;{}\n]*\)|\s[+\-*/|&]?=\s[^;{}\n]+);)(?=[ \t]*$))"
    r"|(?P<truth>\b(?:true|false)\b)"
    r"|(?P<condition>\bif \((?=[^\n]*\)))",
    re.MULTILINE | re.DOTALL,
)
_SWAPS = {
    "<": ("<=", ">="), ">": (">=", "<="), "<=": ("<", ">"), ">=": (">", "<"), "==": ("!=",),
    "!=": ("==",), "===": ("!==",), "!==": ("===",), "&&": ("||",), "||": ("&&",), "+": ("-",),
    "-": ("+",), "*": ("/",), "/": ("*",), "+=": ("-=",), "-=": ("+=",), "!": ("",),
    "++": ("--",), "--": ("++",),
}  # fmt: skip


def _tokens(text: str, draw: random.Random) -> Iterator[Edit]:
    position = 0
    while found := _TOKEN.search(text, position):
        begin, end = found.span()
        position = max(end, begin + 1)
        old = found.group()
        if found.lastgroup == "number":
            value = int(old) if old.isdigit() else float(old)
            new = value + 1 if isinstance(value, int) else draw.choice((10, 0.5, 1.05)) * value
            yield begin, end, repr(new)
        elif found.lastgroup == "operator" and old in _SWAPS:
            yield begin, end, draw.choice(_SWAPS[old])
        elif found.lastgroup == "truth":
            yield begin, end, "false" if old == "true" else "true"
        elif found.lastgroup == "condition":
            yield begin, end, draw.choice(("if (1 || ", "if (0 && "))
        elif found.lastgroup == "statement":
            indent = len(old) - len(old.lstrip())
            yield begin + indent, end, ";"
            position = begin + indent  # and what is in it
            position = _first_token(text, position, end)


def _first_token(text: str, begin: int, end: int) -> int:
    """Where to look on within a statement: behind its first word, which makes it no statement."""
    word = re.compile(r"[\w.\[\]>-]+").match(text, begin)
    return word.end() if word else end
