"""Functions of the core that every class of a system has as a method of its own.

There the calls of the object's methods are direct, and the compiler may put what is called in their
place: a loop of a thousand steps asks no table of functions. In Python they stay functions.
"""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Set

__all__ = ["Calls", "as_method", "called", "directly", "inlined"]


def as_method(node: ast.FunctionDef, name: str) -> ast.FunctionDef:
    """The function as a method `name` of its first argument."""
    method = copy.deepcopy(node)
    method.name = name
    first = method.args.args[0]
    for part in ast.walk(method):
        if isinstance(part, ast.Name) and part.id == first.arg:
            part.id = "self"
    method.args.args[0] = ast.arg("self")
    return method


def called(node: ast.AST, *, always: bool = False) -> set[str]:
    """The names of the object's methods that are called there, or `always`: whatever happens."""
    names = set()
    if isinstance(node, ast.Call) and _of_self(node.func):
        assert isinstance(node.func, ast.Attribute)
        names.add(node.func.attr)
    for part in ast.iter_child_nodes(node):
        if not (always and isinstance(part, ast.If)):
            names |= called(part, always=always)
    return names


def directly(method: ast.FunctionDef, owner: str, known: Set[str]) -> ast.FunctionDef:
    """A copy of the method for the class `owner`: it calls those of the methods `known` of it."""
    method = copy.deepcopy(method)
    for part in ast.walk(method):
        if isinstance(part, ast.Call) and _of_self(part.func):
            assert isinstance(part.func, ast.Attribute)
            if part.func.attr in known:
                part.args.insert(0, ast.Name("self", ast.Load()))
                part.func.value = ast.Name(owner, ast.Load())
    method.body = [part for statement in method.body for part in _apart(statement)]
    return method


def _apart(loop: ast.stmt) -> list[ast.stmt]:
    """A loop with what is asked in each round, and without where the answer is no each time.

    C compilers do not find out that the object's methods leave the answer alone.
    """
    if not isinstance(loop, ast.For):
        return [loop]
    tests = [part.test for part in loop.body if isinstance(part, ast.If)]
    asked = [test for test in tests if isinstance(test, ast.Name)]
    if not asked:
        return [loop]
    never: list[ast.stmt] = [
        ast.Assign([ast.Name(test.id, ast.Store())], ast.Constant(False)) for test in asked
    ]
    return [ast.If(ast.BoolOp(ast.Or(), [*asked]), [loop], [*never, copy.deepcopy(loop)])]


def inlined(c_source: str, methods: Set[str]) -> str:
    """C source that asks for these methods, by their C names, to be put where they are called."""
    if not methods:
        return c_source
    names = "|".join(sorted(methods))
    head = re.compile(rf"^static (\w+ __pyx_f_\w+_(?:{names})\()", re.MULTILINE)
    return head.sub(r"static CYTHON_INLINE \1", c_source)


def _of_self(function: ast.expr) -> bool:
    return isinstance(function, ast.Attribute) and ast.unparse(function.value) == "self"


class Calls(ast.NodeTransformer):
    """Rewrites calls of functions (name -> name of the method) into those of methods."""

    def __init__(self, methods: dict[str, str]) -> None:
        self.methods = methods

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.func, ast.Name) and node.func.id in self.methods:
            method = ast.Attribute(node.args[0], self.methods[node.func.id], ast.Load())
            return ast.Call(method, node.args[1:], node.keywords)
        return node
