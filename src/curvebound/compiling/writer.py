"""From modules to the text of Cython."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from ..errors import CurveboundError
from .c_functions import definitions
from .modules import Module, Unit, absolute, assigned_name
from .repeated import called, directly
from .rewrite import RESERVED, Rewriter, c_name, has_closure, local_names, mangled

__all__ = ["Writer"]

_SCALARS = {"float": "double", "int": "long long", "bool": "bint"}
_OBJECTS = ("list", "dict", "str", "tuple", "bytes", "set")
#: how it shows that a function of this C type has raised
_RAISING = {
    "double": "except? -3.3e-301",
    "long long": "except? -1",
    "bint": "except -1",
    "int": "except -1",
}
_DIRECTIVES = (
    "language_level=3, infer_types=True, binding=False, auto_pickle=False, "
    "always_allow_keywords=False, c_api_binop_methods=False, cpow=False"
)


class Writer:
    """Writes the modules of a unit, one after the other."""

    def __init__(
        self, unit: Unit, core: Unit | None, visible: Mapping[str, Collection[str]]
    ) -> None:
        self.unit = unit
        self.core = core
        self.units = [unit] if core is None else [unit, core]
        self.body: list[str] = []
        #: the declarations that other extension modules need: of the core
        self.declared: list[str] = []
        self.cimported: set[str] = set()
        self.imports: list[str] = []
        self.used: set[str] = set()
        self.visible = visible
        self.module: Module
        self.c_methods: set[str] = set() if core is None else set(core.methods)
        #: functions -> whether they become functions of C
        self.of_c: dict[ast.FunctionDef, bool] = {}

    def write(self) -> None:
        modules = self.unit.ordered()
        for module in modules:
            self.module = module
            self.find_c_functions()
        for module in modules:
            self.module = module
            for node in module.tree.body:
                self.statement(node)
        head = [f"# cython: {_DIRECTIVES}", "cimport cython", "from libc.string cimport memset"]
        head += dict.fromkeys(self.imports)
        if self.cimported:
            assert self.core is not None
            names = ", ".join(sorted(self.cimported))
            head.append(f"from {self.core.name} cimport {names}")
        functions = definitions(self.used)
        self.unit.pyx = "\n".join([*head, "import math", functions, *self.body, ""])
        self.unit.pxd = "\n".join(["cimport cython", *self.declared, ""])

    def find_c_functions(self) -> None:
        """Note the functions and methods of the present module that become C functions."""
        for node in self.module.tree.body:
            if isinstance(node, ast.FunctionDef) and self.is_c(node, ""):
                name = self.module.renamed[node.name]
                self.module.c_functions[node.name] = c_name(name) if name == node.name else name
            if isinstance(node, ast.ClassDef):
                for part in node.body:
                    if isinstance(part, ast.FunctionDef) and self.is_c(part, node.name):
                        self.unit.methods.add(part.name)
        self.c_methods |= self.unit.methods

    # -- names and types ---------------------------------------------------------------------------
    def resolve(self, name: str) -> tuple[str, Any] | None:
        """What a top-level name stands for: ("constant", value), ("name", name) or None."""
        home, original, unit = self.home(name)
        if home is None:
            return None
        if original in home.constants and not isinstance(home.constants[original], list):
            return "constant", home.constants[original]
        if original in home.renamed:
            target = home.c_functions.get(original) or home.renamed[original]
            if unit is self.core:
                self.cimported.add(target)
            return "name", target
        return None

    def home(self, name: str) -> tuple[Module | None, str, Unit | None]:
        """Where a name of the present module is defined: module, name there, unit."""
        source, original = self.module.imported.get(name, (self.module.name, name))
        for unit in self.units:
            if source in unit.modules:
                return unit.modules[source], original, unit
        return None, original, None

    def c_type(self, node: ast.expr | None) -> str:
        """The C type for an annotation; "object" for what has none."""
        if node is None:
            return "object"
        if isinstance(node, ast.Constant):
            return "int" if node.value is None else "object"
        if isinstance(node, ast.Name):
            if node.id in _SCALARS:
                return _SCALARS[node.id]
            if node.id in _OBJECTS:
                return node.id
            home, original, _ = self.home(node.id)
            if home is not None and original in home.aliases:
                here, self.module = self.module, home  # where the names in it mean something
                try:
                    return self.c_type(home.aliases[original])
                finally:
                    self.module = here
            found = self.resolve(node.id)
            return str(found[1]) if found and self.is_class(found[1]) else "object"
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
            outer = node.value.id
            if outer in ("Final", "ClassVar"):
                return self.c_type(node.slice)
            if outer == "Annotated" and isinstance(node.slice, ast.Tuple):
                of, size = node.slice.elts
                assert isinstance(of, ast.Subscript)
                length = eval(self.rewriter().text(size), {})
                return f"{self.c_type(of.slice)}[{length}]"
            if outer == "tuple" and isinstance(node.slice, ast.Tuple):
                parts = [self.c_type(part) for part in node.slice.elts]
                return f"({', '.join(parts)})" if all(p in _RAISING for p in parts) else "tuple"
            if outer in _OBJECTS:
                return outer
        return "object"

    def is_class(self, name: object) -> bool:
        return any(name in unit.classes for unit in self.units)

    def attributes(self, name: str) -> dict[str, str]:
        """Attribute -> C type of a class and its bases."""
        for unit in self.units:
            if name in unit.classes:
                return self.attributes(unit.bases[name]) | unit.classes[name]
        return {}

    def rewriter(self) -> Rewriter:
        return Rewriter(self.resolve, self.used)

    def error(self, node: ast.AST, text: str) -> CurveboundError:
        line = getattr(node, "lineno", 0)
        return CurveboundError(f"{self.module.name}, line {line}: {text}")

    # -- statements --------------------------------------------------------------------------------
    def statement(self, node: ast.stmt) -> None:
        module = self.module
        name = assigned_name(node)
        if isinstance(node, ast.ImportFrom):
            source = absolute(module.name, node)
            known = any(source in unit.modules for unit in self.units)
            if not known and source not in ("__future__", "typing", "collections.abc"):
                self.imports.append(ast.unparse(node))
        elif isinstance(node, ast.Import):
            self.imports.append(ast.unparse(node))
        elif isinstance(node, ast.ClassDef):
            self.class_(node)
        elif isinstance(node, ast.FunctionDef):
            self.function(node)
        elif name in module.constants:
            value = module.constants[name]
            if isinstance(value, list):
                target = module.renamed[name]
                self.body.append(f"cdef double[{len(value)}] {target}\n{target}[:] = {value!r}")
            elif name in module.public:
                self.body.append(f"{name} = {value!r}")
        elif name in module.renamed:
            assert isinstance(node, ast.Assign | ast.AnnAssign)
            assert node.value is not None
            target = module.renamed[name]
            self.body.append(f"{target} = {self.rewriter().text(node.value)}")
            if name in module.public:
                self.body.append(f"{name} = {target}")
        elif not isinstance(node, ast.Expr) and name != "__all__" and name not in module.aliases:
            raise self.error(node, f"not at the top of a kernel module: {ast.unparse(node)}")

    def class_(self, node: ast.ClassDef) -> None:
        name = self.module.renamed[node.name]
        decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
        if len(node.bases) > 1 or decorators not in ([], ["final"]) or (decorators and node.bases):
            raise self.error(
                node, f"{node.name}: a class is final, or has one base and no decorators"
            )
        base = self.rewriter().text(node.bases[0]) if node.bases else ""
        inherited = self.attributes(base)
        self.unit.bases[name] = base
        own = self.unit.classes[name] = {}
        methods = [part for part in node.body if isinstance(part, ast.FunctionDef)]
        self.unit.defined[name] = {method.name for method in methods}
        methods += self.repeated(node.name, name)
        for method in methods:
            for attribute, kind in self.assigned(method):
                if attribute in RESERVED:
                    raise self.error(method, f"an attribute cannot be called {attribute} here")
                if attribute not in inherited:
                    own.setdefault(attribute, kind)
        header = f"cdef class {name}({base}):" if base else f"cdef class {name}:"
        if decorators:  # its methods are called directly
            header = f"@cython.final\n{header}"
        declarations = ["    pass"] if not own else []
        for attribute, kind in own.items():
            public = "public " if attribute in self.visible.get(name, ()) else ""
            declarations.append(f"    cdef {public}{kind} {attribute}")
        self.body.append(header)
        if self.core is None:
            self.declared += [header, *declarations]
        else:
            self.body += declarations
        for part in node.body:
            target = assigned_name(part)
            if target:
                value = getattr(part, "value", None)
                self.body.append(f"    {target} = {self.rewriter().text(value)}" if value else "")
        self.body.append("    pass")
        for method in methods:
            self.function(method, name)

    def repeated(self, shown: str, name: str) -> Iterator[ast.FunctionDef]:
        """What the class `name`, `shown` in its module, of a system repeats of the core."""
        if self.core is None:
            return
        own: set[str] = set()
        base = name
        while base in self.unit.bases:
            own |= self.unit.defined[base]
            base = self.unit.bases[base]
        while base in self.core.bases:
            for method in self.core.repeated.get(base, ()):
                if not self.unit.defined[name].isdisjoint(called(method)):
                    self.unit.inline |= {c_name(name) for name in own & called(method, always=True)}
                    yield directly(method, shown, own)
            base = self.core.bases[base]

    def assigned(self, method: ast.FunctionDef) -> Iterator[tuple[str, str]]:
        """The attributes that a method sets, with the C types of those that say or show theirs."""
        arguments = {a.arg: a.annotation for a in method.args.args}
        for node in ast.walk(method):
            target: ast.expr
            if isinstance(node, ast.AnnAssign):
                target, kind = node.target, self.c_type(node.annotation)
            elif isinstance(node, ast.Assign) and len(node.targets) == 1:
                target, value = node.targets[0], node.value
                kind = "object"
                if isinstance(value, ast.Name) and value.id in arguments:
                    kind = self.c_type(arguments[value.id])
                elif isinstance(value, ast.Call) and isinstance(value.func, ast.Name):
                    kind = self.c_type(value.func)
                elif isinstance(value, ast.Constant):
                    kind = _SCALARS.get(type(value.value).__name__, "object")
            else:
                continue
            if isinstance(target, ast.Attribute) and ast.unparse(target.value) == "self":
                yield target.attr, kind

    def function(self, node: ast.FunctionDef, owner: str = "") -> None:
        """A function, or a method of the class `owner`."""
        if node.decorator_list:
            raise self.error(node, f"{node.name}: no decorators here")
        indent = "    " if owner else ""
        name = node.name if owner else self.module.renamed[node.name]
        is_c = self.is_c(node, owner)
        rewriter = Rewriter(
            self.resolve,
            self.used,
            local_names(node),
            self.unit.bases.get(owner, ""),
            is_c=is_c,
            methods=self.c_methods,
        )
        parts, declared, names = [], [], []
        defaults = [None] * (len(node.args.args) - len(node.args.defaults)) + node.args.defaults
        for argument, default in zip(node.args.args, defaults, strict=True):
            kind = "object" if argument.arg == "self" else self.c_type(argument.annotation)
            if "[" in kind:
                kind = kind.partition("[")[0] + "*"
            if not is_c and kind[-1] in "*)":
                kind = "object"
            text = f"{kind} {mangled(argument.arg)}".removeprefix("object ")
            parts.append(text + (f"={rewriter.text(default)}" if default else ""))
            declared.append(text + ("=*" if default else ""))
            names.append(mangled(argument.arg))
        if is_c:
            result = self.c_type(node.returns)
            is_object = result in ("object", *_OBJECTS) or self.is_class(result)
            tail = "" if is_object else " " + _RAISING.get(result, "except *")
            inner = c_name(name) if owner or name == node.name else name
            self.body.append(f"{indent}cdef {result} {inner}({', '.join(parts)}){tail}:")
            if self.core is None:
                self.declared.append(f"{indent}cdef {result} {inner}({', '.join(declared)}){tail}")
        else:
            self.body.append(f"{indent}def {name}({', '.join(parts)}):")
        for kind, variable in self.variables(node):
            self.body.append(f"{indent}    cdef {kind} {mangled(variable)}")
        statements = node.body
        if isinstance(statements[0], ast.Expr) and isinstance(statements[0].value, ast.Constant):
            statements = statements[1:]
        for statement in statements:
            room = self.room(statement)
            text = rewriter.text(statement) if room is None else room
            self.body += [f"{indent}    {line}" for line in text.splitlines()]
        self.body.append(f"{indent}    pass")
        if is_c and self.is_visible(node, owner, parts):
            self.body.append(f"{indent}def {name}({', '.join(parts)}):")
            call = f"{c_name(name)}({', '.join(names)})"
            if owner:
                call = f"self.{c_name(name)}({', '.join(names[1:])})"
            returns = "" if result == "int" else "return "
            self.body.append(f"{indent}    {returns}{call}")

    def is_c(self, node: ast.FunctionDef, owner: str) -> bool:
        """Whether a function becomes one of C."""
        if node not in self.of_c:
            # a tuple of numbers is another type in each extension module
            returns_tuple = self.c_type(node.returns).startswith("(")
            is_free = not (returns_tuple and owner and self.core is None)
            self.of_c[node] = is_free and node.name != "__init__" and not has_closure(node)
        return self.of_c[node]

    def is_visible(self, node: ast.FunctionDef, owner: str, parts: list[str]) -> bool:
        """Whether Python, too, can call a C function."""
        if any("*" in part for part in parts):
            return False
        if not owner:
            return node.name in (self.module.public if self.core else self.visible.get("", ()))
        # in one class is enough: it calls the function of the object's own class
        return node.name in self.visible.get(owner, ())

    def variables(self, node: ast.FunctionDef) -> Iterator[tuple[str, str]]:
        """C type and name of the variables whose annotations say one."""
        for part in ast.walk(node):
            if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name):
                kind = self.c_type(part.annotation)
                if kind != "object":
                    yield kind, part.target.id

    def room(self, node: ast.stmt) -> str | None:
        """What makes an array of zeros where a list of them was made; None elsewhere."""
        if not isinstance(node, ast.AnnAssign) or "[" not in self.c_type(node.annotation):
            return None
        if isinstance(node.target, ast.Attribute):
            return ""  # a new object's arrays are zero
        name = mangled(ast.unparse(node.target))
        return f"memset({name}, 0, sizeof({name}))"
