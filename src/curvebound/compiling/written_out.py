"""Functions of the kernel that are written out in the place of their calls, loops and all.

So a method with many stages is read as loops over arrays and runs as straight code: every index is
a number, elements of tables are constants, and a local array falls apart into variables that the C
compiler keeps in registers. In Python the functions stay functions.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Collection, Mapping

from ..errors import CurveboundError
from .modules import Unit

__all__ = ["write_out"]

_WHAT_STAYS = (ast.Name, ast.Attribute, ast.Constant)


def write_out(unit: Unit, written_out: Mapping[str, Collection[str]]) -> None:
    """Write out functions (module -> names) where they are called; they are gone afterwards.

    They are a docstring and one return, or statements without a return; the bounds of loops in them
    are known where they are called. What is passed to them is a name, an attribute or a number
    unless it is used once. Arrays that are variables of who calls them (`k: Stages = [0.0] * 8`)
    are used there by known indices, as a target `k[1:8]`, or as arguments `*k`. Raises
    CurveboundError for anything else.
    """
    functions: dict[str, dict[str, ast.FunctionDef]] = {}
    for home, names in written_out.items():
        tree = unit.modules[home].tree
        functions[home] = {
            node.name: node
            for node in tree.body
            if isinstance(node, ast.FunctionDef) and node.name in names
        }
        tree.body = [node for node in tree.body if getattr(node, "name", "") not in names]
    for name, module in unit.modules.items():
        # its own come last: they count where names are the same
        homes = {source for source, _ in module.imported.values() if source in functions}
        visible = [*sorted(homes), name]
        called = {key: node for of in visible for key, node in functions.get(of, {}).items()}
        constants = {key: x for of in visible for key, x in _constants(unit, of).items()}
        inliner = _Inliner(called, constants, {})
        for node in ast.walk(module.tree):
            if isinstance(node, ast.FunctionDef) and any(map(inliner.called, ast.walk(node))):
                node.body = inliner.block(node.body)
                _take_apart(node)
        module.imported = {
            key: (source, original)
            for key, (source, original) in module.imported.items()
            if original not in functions.get(source, {})
        }


def _constants(unit: Unit, name: str) -> dict[str, object]:
    """What is constant in a module, its own and imported."""
    module = unit.modules[name]
    constants: dict[str, object] = {}
    for key, (source, original) in module.imported.items():
        if source in unit.modules and original in unit.modules[source].constants:
            constants[key] = unit.modules[source].constants[original]
    return constants | module.constants


class _Inliner(ast.NodeTransformer):
    """Puts functions in the place of their calls; `known`: names -> what stands for them."""

    def __init__(
        self,
        functions: Mapping[str, ast.FunctionDef],
        constants: Mapping[str, object],
        known: Mapping[str, ast.expr],
        *,
        inside: bool = False,
    ) -> None:
        self.functions = functions
        self.constants = constants
        self.known = known
        self.inside = inside

    def block(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        """The statements with everything written out."""
        return [part for statement in statements for part in self.statement(statement)]

    def statement(self, node: ast.stmt) -> list[ast.stmt]:
        if isinstance(node, ast.Expr) and self.called(node.value):
            function, inner = self.entered(node.value)
            return inner.block(function.body[1:])
        if isinstance(node, ast.For) and self.inside:
            return self.rounds(node)
        node = copy.deepcopy(node)
        for field in ("body", "orelse"):
            if hasattr(node, field):
                setattr(node, field, self.block(getattr(node, field)))
        for name, value in ast.iter_fields(node):
            if isinstance(value, ast.expr):
                setattr(node, name, self.visit(value))
            elif isinstance(value, list) and name not in ("body", "orelse"):
                setattr(node, name, [self.visit(part) for part in value])
        return [node]

    def rounds(self, node: ast.For) -> list[ast.stmt]:
        """A loop over a range, round by round."""
        assert isinstance(node.iter, ast.Call)
        assert isinstance(node.target, ast.Name)
        made: list[ast.stmt] = []
        for i in range(*(self.number(bound) for bound in node.iter.args)):
            known = {**self.known, node.target.id: ast.Constant(i)}
            made += _Inliner(self.functions, self.constants, known, inside=True).block(node.body)
        return made

    def number(self, node: ast.expr) -> int:
        value = _whole(self.visit(copy.deepcopy(node)))
        if value is not None:
            return value
        raise CurveboundError(
            f"line {node.lineno}: the bounds of a loop that is written out "
            f"have to be known: {ast.unparse(node)}"
        )

    def called(self, node: ast.AST) -> bool:
        return (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in self.functions
        )

    def entered(self, node: ast.expr) -> tuple[ast.FunctionDef, _Inliner]:
        """The function that is called there, and what writes it out."""
        assert isinstance(node, ast.Call)
        assert isinstance(node.func, ast.Name)
        function = self.functions[node.func.id]
        passed = [self.visit(copy.deepcopy(argument)) for argument in node.args]
        for parameter, argument in zip(function.args.args, passed, strict=True):
            uses = sum(
                isinstance(part, ast.Name) and part.id == parameter.arg
                for part in ast.walk(ast.Module(function.body, []))
            )
            if uses > 1 and not isinstance(argument, _WHAT_STAYS):
                raise CurveboundError(
                    f"line {node.lineno}: {function.name} is written out and uses "
                    f"{parameter.arg} more than once: pass it a name, not {ast.unparse(argument)}"
                )
        known = {a.arg: value for a, value in zip(function.args.args, passed, strict=True)}
        return function, _Inliner(self.functions, self.constants, known, inside=True)

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if not self.called(node):
            self.generic_visit(node)
            return node
        function, inner = self.entered(node)
        last = function.body[-1]
        if len(function.body) != 2 or not isinstance(last, ast.Return) or last.value is None:
            raise CurveboundError(f"line {node.lineno}: {function.name} is more than one return")
        found: ast.expr = inner.visit(copy.deepcopy(last.value))
        return found

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in self.known:
            return copy.deepcopy(self.known[node.id])
        value = self.constants.get(node.id)
        if isinstance(value, int | float) and isinstance(node.ctx, ast.Load):
            return ast.copy_location(ast.Constant(value), node)
        return node

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        self.generic_visit(node)
        index = _whole(node.slice)
        table = self.constants.get(node.value.id) if isinstance(node.value, ast.Name) else None
        if isinstance(table, list) and index is not None:
            return ast.Constant(table[index])
        return node

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        if _whole(node.left) is None or _whole(node.right) is None:
            return node
        return ast.Constant(eval(ast.unparse(node), {"__builtins__": {}}))

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        self.generic_visit(node)
        whole = _whole(node.operand)
        return node if whole is None or not isinstance(node.op, ast.USub) else ast.Constant(-whole)


def _whole(node: ast.expr | None) -> int | None:
    """The whole number that the expression is, or None."""
    value = node.value if isinstance(node, ast.Constant) else None
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _take_apart(function: ast.FunctionDef) -> None:
    """Make variables of the elements of the arrays that are variables of the function."""
    sizes = {}
    for node in ast.walk(function):
        if isinstance(node, ast.AnnAssign) and isinstance(node.value, ast.BinOp):
            size = _whole(node.value.right)
            if isinstance(node.target, ast.Name) and size is not None:
                sizes[node.target.id] = size
    elements = _Elements(sizes)
    body = [elements.visit(copy.deepcopy(statement)) for statement in function.body]
    for part in (part for statement in body for part in ast.walk(statement)):
        if isinstance(part, ast.Name) and part.id in sizes:
            raise CurveboundError(
                f"{function.name}: the array {part.id} is used as a whole, not by its elements"
            )
    function.body = body


class _Elements(ast.NodeTransformer):
    """Replaces elements of arrays (name -> size) by variables."""

    def __init__(self, sizes: Mapping[str, int]) -> None:
        self.sizes = sizes

    def of(self, node: ast.expr) -> str:
        """The name of the array that the expression is, or ''."""
        return node.id if isinstance(node, ast.Name) and node.id in self.sizes else ""

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.stmt:
        name = self.of(node.target)
        if not name:
            self.generic_visit(node)
            return node
        targets = [ast.Name(f"{name}_{i}", ast.Store()) for i in range(self.sizes[name])]
        return ast.Assign([*targets], ast.Constant(0.0))

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        self.generic_visit(node)
        name = self.of(node.value)
        index = _whole(node.slice)
        if name and index is not None:
            return ast.Name(f"{name}_{range(self.sizes[name])[index]}", node.ctx)
        if name and isinstance(node.slice, ast.Slice):
            first, stop = _whole(node.slice.lower), _whole(node.slice.upper)
            if first is not None and stop is not None:
                elements = [ast.Name(f"{name}_{i}", node.ctx) for i in range(first, stop)]
                return ast.Tuple([*elements], node.ctx)
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        arguments: list[ast.expr] = []
        for argument in node.args:
            name = self.of(argument.value) if isinstance(argument, ast.Starred) else ""
            several = range(self.sizes.get(name, 0))
            arguments += [ast.Name(f"{name}_{i}", ast.Load()) for i in several]
            if not name:
                arguments.append(argument)
        node.args = arguments
        self.generic_visit(node)
        return node
