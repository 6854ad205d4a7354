"""Scenes by name or file."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
from pathlib import Path

from ..errors import CurveboundError, OutsideError, nearest
from ..places import scenarios_directory
from .scene import Scene

__all__ = ["load_scene", "scene_names"]


def scene_names() -> list[str]:
    """Names of the scenes that come with the package."""
    folder = scenarios_directory()
    return sorted(p.stem for p in folder.glob("*.py") if not p.stem.startswith("_"))


def load_scene(which: str | Path) -> Scene:
    """A scene from a file, or one that comes with the package.

    Parameters
    ----------
    which : str or Path
        A Python file (its variable `scene`), an SSP file (.ssp), or a name, see scene_names.

    Returns
    -------
    Scene
        Not yet checked.

    Raises
    ------
    CurveboundError
        There is none, or the script fails.
    """
    path = Path(which)
    if path.suffix == ".ssp":
        from .ssp_read import read_ssp  # and fmpy, which scenes in Python need later if at all

        return read_ssp(path)
    if path.suffix != ".py":
        path = scenarios_directory() / f"{which}.py"
        if not path.is_file():
            known = nearest(str(which), scene_names())
            raise CurveboundError(f"There is no scene {which}; {known}")
    if not path.is_file():
        raise CurveboundError(f"There is no scene file {path}.")
    path = path.resolve()
    # a name of its own for each file: scenes of the same file name in two folders do not mix
    name = f"_curvebound_scene_{hashlib.sha256(str(path).encode()).hexdigest()[:16]}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except CurveboundError:
        raise
    except SystemExit as error:
        raise OutsideError(
            f"{path} ends the program while it is loaded: put scene.main() under "
            '`if __name__ == "__main__":`.'
        ) from error
    except Exception as error:
        raise OutsideError(f"{path} fails to load: {type(error).__name__}: {error}") from error
    finally:
        sys.modules.pop(name, None)
    scene = getattr(module, "scene", None)
    if not isinstance(scene, Scene):
        raise CurveboundError(f"{path} defines no variable `scene` that is a Scene.")
    scene.folder = path.parent
    return scene
