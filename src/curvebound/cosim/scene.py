"""A scene that can be checked, prepared, run, and be a script of its own.

What runs it is imported when it is asked for: to know a scene takes neither numpy nor fmpy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from .scene_data import SceneData

if TYPE_CHECKING:
    from .prepared import Prepared
    from .results import Result
    from .system import System

__all__ = ["Scene"]


class Scene(SceneData):
    """A scene, see SceneData for how it is built."""

    def check(self) -> System:
        """Resolve every name and check everything.

        Returns
        -------
        System
            The scene with its FMUs read, links, order and what will be recorded.

        Raises
        ------
        CurveboundError
            Lists all that is wrong.
        """
        from .resolution import resolve

        return resolve(self)

    def prepare(self) -> Prepared:
        """Load the FMUs, to run them many times: ``with scene.prepare() as prepared: ...``.

        Returns
        -------
        Prepared
            Its ``run(start, stop_time=, step=)`` runs from the start time with other values.

        Raises
        ------
        CurveboundError
            As `check`.
        """
        from .prepared import Prepared

        return Prepared(self)

    def run(self, *, progress: Callable[[float], None] | None = None) -> Result:
        """Run once and free everything.

        Parameters
        ----------
        progress : callable, optional
            Called some times a second with the time reached in s.

        Returns
        -------
        Result
            Arrays of shape (points,) by path.

        Raises
        ------
        CurveboundError
            As `check`.
        RunFailed
            A component failed; its ``result`` holds what was recorded until then.
        """
        with self.prepare() as prepared:
            return prepared.run(progress=progress)

    def main(self, arguments: Sequence[str] | None = None) -> None:
        """Run as ``python SCENE.py``: the options of ``curvebound run``, this scene as its subject.

        Parameters
        ----------
        arguments : sequence of str, optional
            Default: those of the process.

        Raises
        ------
        SystemExit
            Always, with the status.
        """
        from .command import main

        raise SystemExit(main(self, arguments))
