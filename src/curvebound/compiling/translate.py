"""Plain typed Python into Cython: several modules become one extension module.

Annotations of attributes, arguments and results become C types: float, int and bool those of C, a
class of the kernel itself, a list of fixed length (`Annotated[list[float], 7]`) an array.
Constants are written out where they stand; `math.sin` and its like become calls of the C library
that raise what Python's raise. What has no C type stays a Python object, so that any plain Python
is translated, if not made fast.

What Python does not have to see is seen by C alone.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Collection, Mapping

from .modules import Module, Unit, read
from .repeated import Calls, as_method
from .writer import Writer
from .written_out import write_out

__all__ = ["translate"]


def translate(
    name: str,
    sources: Mapping[str, str],
    core: Unit | None = None,
    visible: Mapping[str, Collection[str]] | None = None,
    repeated: Mapping[str, Collection[str]] | None = None,
    written_out: Mapping[str, Collection[str]] | None = None,
) -> Unit:
    """Translate modules (dotted name -> text; they can be imported) into one extension module.

    visible: class -> names of its attributes and methods that Python sees, "" -> functions; where
    there is a `core`, the functions in the modules' `__all__` instead.
    repeated: module -> functions that use nothing but their arguments, the first of them an object
    of a class: each class that another unit derives from it gets a copy of its own.
    written_out: module -> functions that are put in the place of their calls, see write_out().
    The modules may import each other and those of `core`. Raises CurveboundError, with module and
    line, for what cannot be translated.
    """
    unit = Unit(name, {key: read(key, text) for key, text in sources.items()})
    unit.visible = frozenset().union(*(visible or {}).values())
    for module, functions in (repeated or {}).items():
        _repeat(unit, unit.modules[module], functions)
    write_out(unit, written_out or {})
    Writer(unit, core, visible or {}).write()
    return unit


def _repeat(unit: Unit, module: Module, functions: Collection[str]) -> None:
    """Make functions of a module methods of the class of their first argument."""
    short = module.name.rpartition(".")[2]
    methods = {name: f"{short}__{name}" for name in functions}
    for node in [node for node in module.tree.body if getattr(node, "name", "") in methods]:
        assert isinstance(node, ast.FunctionDef)
        module.tree.body.remove(node)
        kind = ast.unparse(node.args.args[0].annotation or ast.Name("object"))
        home, name = module.imported.get(kind, (module.name, kind))
        method = as_method(node, methods[node.name])
        for part in unit.modules[home].tree.body:
            if isinstance(part, ast.ClassDef) and part.name == name:
                part.body.append(method)
        unit.repeated.setdefault(name, []).append(copy.deepcopy(method))
    Calls(methods).visit(module.tree)
