"""The folder of a system: where it is found, what is declared in it, what travels in its FMU.

fmu.py               FMU: variables, units, domains, enumerations
mechanics.py         MECHANICS: the physics, as on a blackboard; a control law has none
kernel.py            the accelerations by hand, or the law; optional where there are mechanics
reference.py         what is known of the motion besides, for references; optional
drawing.py           DRAWING: what to draw, SKETCH: its symbols in the documentation; optional
documentation.html   what the FMU's page tells, with the pictures *.svg; optional
icon.png             optional
"""

from __future__ import annotations

import ast
import hashlib
import importlib
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from ..errors import CurveboundError
from ..mechanics.derive import derive
from ..mechanics.derived import Derived
from ..places import fmus_directory
from .declaration import Fmu
from .declared import check_kernel, check_names, check_starts, check_variables
from .drawing import FRAME, Drawing, Point, complete, known, mass_arrows
from .implied import complete_variables, left_open
from .sketch import Sketch

if TYPE_CHECKING:
    from .engine import System

__all__ = [
    "BESIDE",
    "DECLARATION",
    "Folder",
    "find",
    "fmu_name",
    "names",
    "shipped_drawings",
    "systems_in",
]

#: the folder beside a scene, or in the working directory, in which systems are found by name
BESIDE = "systems"
#: in an FMU, the module with the declaration
DECLARATION = "declaration"
#: names of folders, whose FMUs are classes: none is a word of Python
_NAME = re.compile(r"(?!(?:none|true|false)$)[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
#: what makes engines -> what it needs of kernel.py
_FACTORIES = {"Plant": "model", "Controller": "law"}


def fmu_name(name: str) -> str:
    """The name of the FMU of a folder called `name`: MySystem of my_system.

    Raises CurveboundError where that cannot be the name of a system.
    """
    if not _NAME.fullmatch(name):
        raise CurveboundError(
            f"{name!r} cannot be the name of a system: use small letters, digits and single "
            "underscores, a letter first, as in my_system, whose FMU is called MySystem"
        )
    return "".join(word.capitalize() for word in name.split("_"))


@dataclass(frozen=True)
class Folder:
    """A system's folder."""

    path: Path

    @property
    def name(self) -> str:
        """The name of its FMU."""
        return self.system_name

    @property
    def system_name(self) -> str:
        """The system's name: that of the folder, in capitals instead of underscores."""
        return fmu_name(self.path.name)

    def module(self, name: str) -> ModuleType:
        """One of its Python modules, imported as part of a package of its own.

        Folders of one name do not mix, nor does one with what it was before an edit: the package
        is named after place and content. Raises CurveboundError where the module fails.
        """
        package = self._package()
        if name == "kernel" and not self.has("kernel"):
            return self._derived_kernel(package)
        writes = sys.dont_write_bytecode
        sys.dont_write_bytecode = True  # an edit within the same second would go unseen
        try:
            importlib.invalidate_caches()
            return importlib.import_module(f"{package}.{name}")
        except CurveboundError:
            raise
        except Exception as error:
            raise CurveboundError(
                f"{self.path / name}.py fails to load: {type(error).__name__}: {error}"
            ) from error
        finally:
            sys.dont_write_bytecode = writes

    def has(self, module: str) -> bool:
        """Whether it has that module."""
        return (self.path / f"{module}.py").is_file()

    def derived(self) -> Derived:
        """What follows from its mechanics.py; CurveboundError where it has none."""
        if not self.has("mechanics"):
            raise CurveboundError(
                f"{self.path} has neither a mechanics.py nor a kernel.py: state the physics in the "
                "one, or the accelerations in the other"
            )
        return derive(self.path / "mechanics.py", self.system_name)

    def _derived_kernel(self, package: str) -> ModuleType:
        """The module whose source is derived, as if it stood in the folder."""
        name = f"{package}.kernel"
        if name not in sys.modules:
            text = self.derived().kernel
            module = ModuleType(name)
            sys.modules[name] = module
            exec(compile(text, f"{self.path / 'kernel.py'} (derived)", "exec"), module.__dict__)
        return sys.modules[name]

    def _package(self) -> str:
        """The package of which its modules are part; made where it is new."""
        digest = hashlib.sha256(str(self.path).encode())
        for source in sorted(self.path.glob("*.py")):
            digest.update(f"\0{source.name}\0".encode() + source.read_bytes())
        name = f"curvebound_system_{self.path.name}_{digest.hexdigest()[:12]}"
        if name not in sys.modules:
            package = ModuleType(name)
            package.__path__ = [str(self.path)]
            sys.modules[name] = package
        return name

    def fmu(self) -> Fmu:
        """The declaration, FMU in fmu.py, with all variables and the system that runs."""
        fmu = self.declaration()
        system = self._system()
        model = getattr(self.module("kernel"), "model", None)
        if self.has("kernel") and model is not None:
            check_kernel(fmu, model, self.path / "fmu.py")
        return fmu._replace(system=system)

    def declaration(self) -> Fmu:
        """The same, without the system."""
        source = self.path / "fmu.py"
        name = self.system_name
        fmu = getattr(self.module("fmu"), "FMU", None)
        if not isinstance(fmu, Fmu):
            raise CurveboundError(f"{source} declares no FMU: write FMU = Fmu(...)")
        if fmu.name != name:
            raise CurveboundError(
                f"{source} declares an FMU {fmu.name!r}: call it {name!r}, or rename the folder"
            )
        check_variables(fmu.variables, source)
        if not self.has("kernel"):
            variables = complete_variables(fmu.variables, self.derived(), source)
            fmu = fmu._replace(variables=variables)
        check_starts(fmu, source)
        check_names(fmu, source)
        return fmu

    def left_open(self) -> list[str]:
        """Parameters and inputs of mechanics.py of which fmu.py says nothing that is needed."""
        if self.has("kernel"):
            return []
        return left_open(self.module("fmu").FMU.variables, self.derived())

    def _system(self) -> System:
        """What makes engines: of a plant, `model` in kernel.py, or of a controller, `law`."""
        from .controller import Controller  # with all methods: what only names systems needs none
        from .plant import Plant

        kernel = self.module("kernel")
        if hasattr(kernel, "model"):
            return Plant(kernel.model)
        if hasattr(kernel, "law"):
            return Controller(kernel.law)
        raise CurveboundError(
            f"{self.path / 'kernel.py'} defines neither model(choices), which gives the Model of a "
            "plant, nor law(), which gives a controller's Law"
        )

    def drawing(self) -> Drawing:
        """DRAWING in drawing.py, completed; without one there are the masses, or plots only."""
        drawing = Drawing()
        if self.has("drawing"):
            made = getattr(self.module("drawing"), "DRAWING", None)
            if not isinstance(made, Drawing):
                raise CurveboundError(
                    f"{self.path / 'drawing.py'} declares no drawing: write DRAWING = Drawing(...)"
                )
            drawing = made
        elif self.has("mechanics"):
            derived = self.derived()
            frame = derived.frame
            drawing = Drawing(
                points=tuple(Point(name, f"{name}.x", f"{name}.y") for name in derived.masses),
                arrows=tuple(one for name in derived.masses for one in mass_arrows(name)),
                frame=(f"{frame}.x", f"{frame}.y") if frame else ("0", "0"),
            )
        return complete(drawing, self.declaration())

    def sketch(self, drawing: Drawing) -> Sketch | None:
        """SKETCH in drawing.py, None without one; `drawing` is that of the system.

        Raises CurveboundError where it names what the drawing or the FMU lacks.
        """
        made: Sketch | None = None
        if self.has("drawing"):
            made = getattr(self.module("drawing"), "SKETCH", None)
        if made is None:
            return None
        if not isinstance(made, Sketch):
            raise CurveboundError(
                f"{self.path / 'drawing.py'} has a SKETCH that is none: write SKETCH = Sketch(...)"
            )
        points = {FRAME, *(point.name for point in drawing.points)}
        for name in (*made.masses, *(end for one in made.lengths for end in one[:2])):
            known(drawing, name, points, "a point of the drawing")
        for one in made.angles:
            known(drawing, one.at, points, "a point of the drawing")
            known(drawing, one.towards, points, "a point of the drawing")
        for name in sorted(made.variables()):
            known(drawing, name, drawing.units, "a variable")
        return made

    def documentation(self) -> str:
        """HTML: equations, how to couple it, what accuracy costs."""
        path = self.path / "documentation.html"
        return path.read_text(encoding="utf-8") if path.is_file() else ""

    def statement(self) -> dict[str, bytes]:
        """What studies are made from: mechanics.py and reference.py, where they are."""
        paths = [self.path / name for name in ("mechanics.py", "reference.py")]
        return {path.name: path.read_bytes() for path in paths if path.is_file()}

    def sources(self) -> dict[str, str]:
        """The modules that travel in the FMU: the declaration, written anew, and the kernel.

        Module, as it would be imported here -> text.
        """
        package = self._package()
        found = {f"{package}.{DECLARATION}": self._declaration_text()}
        if not self.has("kernel"):
            return {**found, f"{package}.kernel": self.derived().kernel}
        waiting = ["kernel"]
        while waiting:
            name = waiting.pop()
            if f"{package}.{name}" not in found:
                path = self.path / f"{name}.py"
                found[f"{package}.{name}"] = path.read_text(encoding="utf-8")
                waiting += sorted(_siblings(path))
        return dict(sorted(found.items()))

    def _declaration_text(self) -> str:
        """A module with what an FMU needs of its declaration while it runs."""
        fmu = self.fmu()
        face = type(fmu.system).__name__
        factory = _FACTORIES[face]
        own: dict[str, object] = {"name": fmu.name, "description": fmu.description}
        own |= {"stop_time": fmu.stop_time, "step_size": fmu.step_size}
        if fmu.shown:
            own["shown"] = fmu.shown
        lines = [
            "from curvebound.fmi.declaration import Enumeration, Fmu, Variable",
            f"from curvebound.fmi.{face.lower()} import {face}",
            "",
            f"from .kernel import {factory}",
            "",
            "FMU = Fmu(",
            *(f"    {name}={value!r}," for name, value in own.items()),
            f"    system={face}({factory}),",
            "    variables=(",
            *(f"        {variable!r}," for variable in fmu.variables),
            "    ),",
            ")",
        ]
        return "\n".join([*lines, ""])


def _siblings(path: Path) -> set[str]:
    """The modules that a module imports from its own folder."""
    return {
        node.module or alias.name
        for node in ast.walk(ast.parse(path.read_bytes()))
        if isinstance(node, ast.ImportFrom) and node.level == 1
        for alias in node.names
    }


def systems_in(folder: Path) -> list[Folder]:
    """The systems whose folders are in `folder`, by name."""
    found = [path.parent.resolve() for path in sorted(folder.glob("*/fmu.py"))]
    return [Folder(path) for path in found if _NAME.fullmatch(path.name)]


def names() -> list[str]:
    """The FMUs that come with the package: one folder each in fmus/."""
    return [system.name for system in systems_in(fmus_directory())]


def find(which: str | Path, beside: Path | None = None) -> Folder:
    """The folder of a system.

    which: a path to it, from `beside` on; or the name of its FMU, MySystem, or of its folder,
        my_system, in the folder `systems` that is beside, or among those of the package.
    beside: the folder of the scene that names it; by default the working directory.

    Raises CurveboundError where there is none.
    """
    here = Path.cwd() if beside is None else beside
    path = Path(which)
    as_path = (here / path.expanduser()).resolve()
    if isinstance(which, str) and path.name == which:
        stem = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", which).lower()
        places = [here / BESIDE / stem, fmus_directory() / stem, as_path]
    else:
        places = [as_path]
    for place in places:
        if (place / "fmu.py").is_file():
            return Folder(place.resolve())
    if len(places) == 1:
        raise CurveboundError(
            f"{as_path} is no folder of a system: it has no fmu.py; "
            "`curvebound new NAME` writes one that runs"
        )
    others = [system.name for system in systems_in(here / BESIDE)]
    raise CurveboundError(
        f"there is no FMU {which!r}: choose one of {', '.join(sorted({*names(), *others}))}, or "
        "give the path of a system's folder"
    )


def shipped_drawings() -> list[Drawing]:
    """The drawings of the systems that come with the package."""
    return [system.drawing() for system in systems_in(fmus_directory())]
