"""Rewriting the bodies of functions: names, constants, calls of `math` and of base classes."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Set
from typing import Any

from .c_functions import C_FUNCTIONS, TO_WHOLE

__all__ = ["RESERVED", "Rewriter", "c_name", "has_closure", "local_names", "mangled"]

#: words that Cython takes for something else than a name
RESERVED = frozenset(
    (
        *("bint", "by", "cdef", "char", "cimport", "const", "cpdef", "ctypedef", "double", "enum"),
        *("extern", "gil", "include", "inline", "long", "namespace", "new", "nogil", "public"),
        *("readonly", "short", "signed", "sizeof", "struct", "union", "unsigned", "void"),
        "volatile",
    )
)


def c_name(name: str) -> str:
    """The name of a C function beside that which Python calls."""
    return f"c_{name}"


def mangled(name: str) -> str:
    """A name that Cython takes for one."""
    return f"{name}_" if name in RESERVED else name


def has_closure(node: ast.FunctionDef) -> bool:
    """Whether a function makes functions, which one with a C signature cannot."""
    inner = (ast.GeneratorExp, ast.Lambda, ast.FunctionDef, ast.Yield)
    return any(isinstance(part, inner) for part in ast.walk(node) if part is not node)


def local_names(node: ast.FunctionDef) -> frozenset[str]:
    """Arguments and variables of a function, those of its comprehensions included."""
    names = {argument.arg for argument in (*node.args.args, *node.args.kwonlyargs)}
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            names.add(part.id)
        elif isinstance(part, ast.ExceptHandler) and part.name:
            names.add(part.name)
    return frozenset(names)


class Rewriter(ast.NodeTransformer):
    """Rewrites a piece of one module; `used` collects the C functions it needs.

    methods: names of methods that are C functions.
    resolve: top-level name -> ("constant", value), ("name", name) or None for any other.
    """

    def __init__(
        self,
        resolve: Callable[[str], tuple[str, Any] | None],
        used: set[str],
        local: frozenset[str] = frozenset(),
        base: str = "",
        *,
        is_c: bool = False,
        methods: Set[str] = frozenset(),
    ) -> None:
        self.resolve = resolve
        self.used = used
        self.local = local
        self.base = base
        self.is_c = is_c
        self.methods = methods

    def text(self, node: ast.AST) -> str:
        """The rewritten piece as source."""
        return ast.unparse(ast.fix_missing_locations(self.visit(node)))

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in self.local:
            return ast.Name(mangled(node.id), node.ctx)
        found = self.resolve(node.id)
        if found is None:
            return node
        kind, value = found
        return ast.Constant(value) if kind == "constant" else ast.Name(value, node.ctx)

    def visit_keyword(self, node: ast.keyword) -> ast.keyword:
        self.generic_visit(node)
        if node.arg:
            node.arg = mangled(node.arg)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id == "math":
            if node.attr in ("inf", "nan"):
                return ast.Name("INFINITY" if node.attr == "inf" else "NAN", ast.Load())
            if node.attr in ("pi", "e", "tau"):
                return ast.Constant(getattr(math, node.attr))
            if node.attr in C_FUNCTIONS and node.attr not in (*TO_WHOLE, "int"):
                return self.c_function(node.attr)
            return node
        self.generic_visit(node)
        return node

    def c_function(self, name: str) -> ast.Name:
        self.used.add(C_FUNCTIONS[name])
        return ast.Name(C_FUNCTIONS[name], ast.Load())

    def visit_Call(self, node: ast.Call) -> ast.expr:
        function = node.func
        if isinstance(function, ast.Name) and len(node.args) == 1 and function.id not in self.local:
            if function.id == "int":
                return ast.Call(self.c_function("int"), [self.visit(node.args[0])], [])
            inner = node.args[0]
            if function.id == "float" and isinstance(inner, ast.Call):
                for name in TO_WHOLE:
                    if ast.unparse(inner.func) == f"math.{name}":
                        arguments = [self.visit(argument) for argument in inner.args]
                        return ast.Call(self.c_function(name), arguments, [])
        if isinstance(function, ast.Attribute) and ast.unparse(function.value) == "super()":
            name = c_name(function.attr) if function.attr in self.methods else function.attr
            of_base = ast.Attribute(ast.Name(self.base, ast.Load()), name, ast.Load())
            arguments = [ast.Name("self", ast.Load()), *map(self.visit, node.args)]
            return ast.Call(of_base, arguments, [self.visit(k) for k in node.keywords])
        self.generic_visit(node)
        if isinstance(function, ast.Attribute) and function.attr in self.methods:
            function.attr = c_name(function.attr)
        return node

    def visit_Return(self, node: ast.Return) -> ast.stmt:
        if node.value is None:
            # C functions that return nothing return an int that says whether they raised
            return ast.Return(ast.Constant(0)) if self.is_c else node
        self.generic_visit(node)
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.stmt:
        # the type of a variable is declared at the head of the function, that of an attribute in
        # the class
        if node.value is None:
            return ast.Pass()
        return ast.Assign([self.visit(node.target)], self.visit(node.value))
