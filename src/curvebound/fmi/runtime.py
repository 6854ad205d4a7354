"""The sources that travel inside an FMU, and the names that tell their content.

Python modules are shared by the whole process: equal names must mean equal code. So the package
that all FMUs carry, that of an FMU's own system, and the extension modules compiled from both bear
hashes of what they are made of.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from ..compiling.modules import absolute
from .folder import DECLARATION, Folder

__all__ = [
    "REPEATED",
    "VISIBLE",
    "WRITTEN_OUT",
    "Runtime",
    "SystemSources",
    "runtime",
    "system_sources",
]

_PACKAGE = Path(__file__).resolve().parents[1]
_ROOT = "curvebound"

#: what runs interpreted in any case: touched once per instance
_INTERPRETED = (
    "kernel/__init__.py",
    "fmi/__init__.py",
    "fmi/declaration.py",
    "fmi/loading.py",
    "fmi/ranges.py",
    "fmi/slave.py",
    "fmi/wrapped.py",
)
_OTHERS = ("common", "declaration", "slave", "wrapped")
_FACES = (
    *("controller", "cutting", "derivatives", "direct", "engine", "input_slopes", "plant", "table"),
    "watch",
)
#: decides, with the sources, what is compiled from them
_TRANSLATOR = (
    *("c_functions", "extension", "modules", "repeated", "rewrite", "translate", "writer"),
    "written_out",
)
#: what Python calls of the compiled kernel: class -> attributes and methods, "" -> functions
VISIBLE = {
    "": ("create",),
    "Message": ("status", "category", "msg", "debug"),
    "Model": (
        *("q0", "q1", "v0", "v1", "magnification"),
        *("start", "set_inputs", "get_state", "set_state"),
    ),
    "Method": (
        *("steps", "evaluations", "doubt", "loss", "advance", "reset"),
        *("get_state", "set_state"),
    ),
    "Engine": (
        *("queue", "do_step", "get_real", "set_real", "get_integer", "set_integer"),
        *("setup_experiment", "enter_initialization", "exit_initialization", "terminate", "reset"),
        *("get_state", "set_state", "say", "unknown", "dependencies"),
        "has_changes",
    ),
    "DerivativeEngine": (
        *("set_real_input_derivatives", "get_real_output_derivatives"),
        "get_directional_derivative",
    ),
    "System": ("create",),
}
#: the loops in which the time goes
REPEATED = {"curvebound.kernel.rk4": ("steps",)}
#: loops over the stages of a method
WRITTEN_OUT = {
    "curvebound.kernel.implicit": ("ahead", "evaluate", "find_powers", "find_times", "place"),
    "curvebound.kernel.polynomial": ("evaluate_at", "extend", "find_coefficients", "miss", "span"),
    "curvebound.kernel.lobatto": (
        *("estimated", "evaluate", "find_powers", "moves", "place", "proceed", "quadrature"),
    ),
    "curvebound.kernel.newton": ("add", "correct", "evaluate", "linearise", "shift", "subtract"),
    "curvebound.kernel.stages": ("apart", "copy", "fill", "follow", "weighted"),
}


class Runtime(NamedTuple):
    """One reading of the sources that all FMUs carry."""

    #: path inside the package -> content
    files: dict[str, bytes]
    #: what is compiled: module -> text
    kernel: dict[str, str]
    #: twelve hexadecimal digits that change with any line
    digest: str
    #: name of the extension module
    extension: str

    def package(self, *, compiled: bool) -> str:
        """Name of the package inside an FMU; compiled and interpreted ones do not share modules."""
        # it holds modules of PythonFMU, too
        digest = _digest(self.digest.encode(), version("pythonfmu").encode())
        return f"{_ROOT}_{digest}{'c' if compiled else ''}"

    def text(self, *, compiled: bool) -> dict[str, bytes]:
        """The package: path below the FMU's resources -> content."""
        package = self.package(compiled=compiled)
        files = {f"{package}/{path}": content for path, content in self.files.items()}
        names = [name.replace(_ROOT, package, 1) for name in self.kernel]
        files[f"{package}/__init__.py"] = _init(
            self.extension if compiled else "",
            [*names, *(f"{package}.fmi.{name}" for name in ("declaration", "slave", "wrapped"))],
            names,
        )
        return files


class SystemSources(NamedTuple):
    """One reading of the modules of a system's folder that travel in its FMU."""

    #: declaration and kernel: module -> text
    files: dict[str, str]
    #: what is compiled of them
    kernel: dict[str, str]
    #: name of the extension module
    extension: str

    def text(self, package: str, system: str, *, compiled: bool) -> dict[str, bytes]:
        """The package `system` in an FMU whose package for all systems is `package`.

        Path below the FMU's resources -> content.
        """
        places = {name: f"{system}.{name.rpartition('.')[2]}" for name in self.files}
        names = [places[name] for name in self.kernel]
        return {
            f"{system}/__init__.py": _init(
                self.extension if compiled else "", [*places.values()], names, package
            ),
            **{
                f"{place.replace('.', '/')}.py": _moved(text, name, {**places, _ROOT: package})
                for (name, place), text in zip(places.items(), self.files.values(), strict=True)
            },
        }


def _moved(text: str, module: str, places: Mapping[str, str]) -> bytes:
    """The text of a module that imports from `places`, by module or package, what it does now."""
    lines = text.splitlines(keepends=True)
    for node in ast.parse(text).body:
        if isinstance(node, ast.ImportFrom):
            source = absolute(module, node)
            root, dot, rest = source.partition(".")
            target = places.get(source) or (f"{places[root]}{dot}{rest}" if root in places else "")
            if target:
                line = lines[node.lineno - 1]
                lines[node.lineno - 1] = f"from {target} import{line.partition(' import')[2]}"
    return "".join(lines).encode()


def runtime() -> Runtime:
    """Read the sources that all FMUs carry."""
    kernel = sorted(p.stem for p in (_PACKAGE / "kernel").glob("*.py") if p.stem != "__init__")
    compiled = [*(f"kernel/{name}.py" for name in kernel), *(f"fmi/{name}.py" for name in _FACES)]
    files = {name: (_PACKAGE / name).read_bytes() for name in (*compiled, *_INTERPRETED)}
    modules = {f"{_ROOT}.{name[:-3].replace('/', '.')}": files[name].decode() for name in compiled}
    translator = [(_PACKAGE / "compiling" / f"{name}.py").read_bytes() for name in _TRANSLATOR]
    digest = _digest(*translator, **files)
    settings = repr((VISIBLE, REPEATED, WRITTEN_OUT)).encode()
    extension = f"{_ROOT}_core_{_digest(*translator, settings, **modules)}"
    return Runtime(files, modules, digest, extension)


def system_sources(folder: Folder, core: Runtime) -> SystemSources:
    """Read what an FMU carries of a system's folder."""
    files = folder.sources()
    stems = {name.rpartition(".")[2]: name for name in files}
    kernel = {name: files[name] for stem, name in stems.items() if stem != DECLARATION}
    texts = {stem: files[name] for stem, name in stems.items() if stem != DECLARATION}
    digest = _digest(core.extension.encode(), **texts)
    return SystemSources(files, kernel, f"{folder.system_name}_kernel_{digest}")


def _digest(*parts: bytes, **named: bytes | str) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(b"%d\0" % len(part) + part)
    for name, content in sorted(named.items()):
        data = content.encode() if isinstance(content, str) else content
        digest.update(name.encode() + b"\0%d\0" % len(data) + data)
    return digest.hexdigest()[:12]


def _init(extension: str, modules: list[str], compiled: list[str], core: str = "") -> bytes:
    """The __init__ of a package inside an FMU; `core`: the package on which that of a system rests.

    It imports everything at once: a second FMU of the same sources uses the first one's modules,
    and must not need a file of it after its folder has been deleted.
    """
    if extension and not core:
        package = compiled[0].partition(".")[0]
        lines = [
            f"from {package}.fmi.loading import adopt",
            f"NOT_COMPILED = adopt({extension!r}, {tuple(compiled)!r})",
        ]
    elif extension:
        # compiled or interpreted, but both alike
        lines = [
            f"from {core} import NOT_COMPILED",
            f"from {core}.fmi.loading import adopt",
            "if not NOT_COMPILED:",
            f"    adopt({extension!r}, {tuple(compiled)!r}, required=True)",
        ]
    else:
        lines = ["NOT_COMPILED = 'it was built without compiled code'"]
    lines += [f"from {module} import __name__ as _" for module in modules]
    return "\n".join([*lines, ""]).encode()
