"""FMI 2.0 co-simulation FMUs of bodies bound to curves, and the tools to trust and use them.

What a script needs, each with a docstring of its own (``help(curvebound.Scene)``):

=========================================  ======================================================
``Scene(name, stop_time=, step=)``         FMUs joined to a scene: ``add``, ``connect``, ``input``,
                                           ``record``, ``run``
``load_scene(name_or_file)``               a scene of the package, of a script or of an SSP file
``run(scene, start)``                      run it once: a ``Result``
``Result``                                 ``result.time``, ``result[path]``, ``result.write(file)``
``RunFailed``                              a run that ended early, with its ``result`` until then
``read_csv(file)``                         what ``Result.write`` wrote
``build(system, folder)``                  the FMU of a system: a ``BuiltFmu``
``linearize(system, at)``                  A, B, C, D with names and units: a ``LinearModel``
``tune(scene, bounds)``                    the cheapest setting that meets the bounds: a ``Choice``
``sweep(scene, vary, out)``                runs over a grid or hypercube of parameters, into a file
``CurveboundError``                        what went wrong, with what and how to mend it
=========================================  ======================================================

>>> import curvebound
>>> result = curvebound.run("bead_on_wire", {"bead.wire.radius": 2.0}, stop_time=1.0)
>>> result["bead.bead.angle"].shape == result.time.shape
True

Values are in SI units, angles in rad; paths are ``component.variable``. `curvebound.mechanics`
states the physics of a system, `curvebound.checks` holds one to it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import run, sweep, tune
    from .cosim.load import load_scene
    from .cosim.results import Result, RunFailed
    from .cosim.scene import Scene
    from .errors import CurveboundError
    from .fmi.build import build
    from .study.linear_model import linearize

__version__ = "0.2.0"
__all__ = [
    "CurveboundError",
    "Result",
    "RunFailed",
    "Scene",
    "build",
    "linearize",
    "load_scene",
    "read_csv",
    "run",
    "sweep",
    "tune",
]

#: date of the sources, which dates the FMUs built from them
__date__ = "2026-11-26"

_HOME = {
    "api": ("run", "sweep", "tune"),
    "cosim.load": ("load_scene",),
    "cosim.results": ("Result", "RunFailed"),
    "cosim.tables": ("read_csv",),
    "cosim.scene": ("Scene",),
    "errors": ("CurveboundError",),
    "fmi.build": ("build",),
    "study.linear_model": ("linearize",),
}


def __getattr__(name: str) -> Any:
    # imported when first used: with numpy and all, and not needed for most commands
    for module, names in _HOME.items():
        if name in names:
            return getattr(import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__} has no attribute {name}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
