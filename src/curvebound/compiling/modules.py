"""Source modules that are translated together, and what their names stand for."""

from __future__ import annotations

import ast
import importlib
from dataclasses import dataclass, field
from typing import Any

from .rewrite import c_name

__all__ = ["Module", "Unit", "absolute", "assigned_name", "read"]


@dataclass
class Module:
    """A source module, and what its top-level names stand for."""

    name: str
    tree: ast.Module
    public: frozenset[str] = frozenset()
    #: local name -> (module, name there)
    imported: dict[str, tuple[str, str]] = field(default_factory=dict)
    #: numbers and lists of floats
    constants: dict[str, Any] = field(default_factory=dict)
    #: names of types
    aliases: dict[str, ast.expr] = field(default_factory=dict)
    #: functions, classes and other values -> their names in the extension module
    renamed: dict[str, str] = field(default_factory=dict)
    #: functions -> the names of their C forms
    c_functions: dict[str, str] = field(default_factory=dict)


@dataclass
class Unit:
    """Modules translated together into the extension module `name`."""

    name: str
    modules: dict[str, Module]
    #: class -> its base, and attribute -> C type
    bases: dict[str, str] = field(default_factory=dict)
    classes: dict[str, dict[str, str]] = field(default_factory=dict)
    #: names of methods that are C functions, and for Python's sake a method that calls it
    methods: set[str] = field(default_factory=set)
    #: class -> names of the methods that it defines
    defined: dict[str, set[str]] = field(default_factory=dict)
    #: class -> methods that each class derived from it has for itself
    repeated: dict[str, list[ast.FunctionDef]] = field(default_factory=dict)
    #: C names of methods that are best put in the place of their calls
    inline: set[str] = field(default_factory=set)
    #: names of attributes that Python sees
    visible: frozenset[str] = frozenset()
    pyx: str = ""
    pxd: str = ""

    def hidden(self) -> set[str]:
        """Names of attributes and methods that Python does not see."""
        names = {c_name(method) for method in self.methods}
        return names.union(*self.classes.values()) - self.visible

    def ordered(self) -> list[Module]:
        """The modules, each after those that it imports."""
        found: list[Module] = []

        def visit(module: Module) -> None:
            if module not in found:
                for source, _ in module.imported.values():
                    if source in self.modules:
                        visit(self.modules[source])
                found.append(module)

        for module in self.modules.values():
            visit(module)
        return found


def read(name: str, text: str) -> Module:
    """The module of that name, which can be imported, from its text."""
    module = Module(name, ast.parse(text))
    loaded = importlib.import_module(name)
    module.public = frozenset(getattr(loaded, "__all__", ()))
    short = name.rpartition(".")[2]
    for node in module.tree.body:
        target = assigned_name(node)
        if isinstance(node, ast.ImportFrom):
            source = absolute(name, node)
            for alias in node.names:
                module.imported[alias.asname or alias.name] = (source, alias.name)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            public = node.name in module.public
            module.renamed[node.name] = node.name if public else f"{short}__{node.name}"
        elif target and target != "__all__":
            value = getattr(loaded, target)
            assert isinstance(node, ast.Assign | ast.AnnAssign)
            if isinstance(node.value, ast.Subscript) and not isinstance(value, float | int):
                module.aliases[target] = node.value
                continue
            module.renamed[target] = f"{short}__{target}"
            is_list = isinstance(value, list) and all(isinstance(x, float) for x in value)
            if isinstance(value, float | int) or is_list:
                module.constants[target] = value
    return module


def absolute(importer: str, node: ast.ImportFrom) -> str:
    """The module from which the module `importer` imports there."""
    if not node.level:
        return node.module or ""
    base = importer.split(".")[: -node.level]
    return ".".join([*base, node.module] if node.module else base)


def assigned_name(node: ast.stmt) -> str:
    """The name to which a statement assigns, or ''."""
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        return node.target.id
    if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        return node.targets[0].id
    return ""
