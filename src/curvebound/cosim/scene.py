"""A scene that can be checked, prepared, run, and be a script of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from .command import main
from .prepared import Prepared
from .resolution import resolve
from .results import Result
from .scene_data import SceneData
from .system import System

__all__ = ["Scene"]


class Scene(SceneData):
    """A scene, see SceneData for how it is built."""

    def check(self) -> System:
        """Resolve every name and check everything; CurveboundError lists all that is wrong."""
        return resolve(self)

    def prepare(self) -> Prepared:
        """FMUs loaded and instantiated, ready to run many times: see curvebound.cosim.prepared."""
        return Prepared(self)

    def run(self, *, progress: Callable[[float], None] | None = None) -> Result:
        """Run once and free everything.

        progress: called some times a second with the time reached in s.
        Raises RunFailed, which holds the result up to the failure.
        """
        with Prepared(self) as prepared:
            return prepared.run(progress=progress)

    def main(self, arguments: Sequence[str] | None = None) -> None:
        """Run as `python SCENE.py`: the options of `curvebound run`, this scene as its subject."""
        raise SystemExit(main(self, arguments))
