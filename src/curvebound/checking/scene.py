"""The checks of one scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from ..cosim import Result, RunFailed, Scene, load_scene
from ..cosim.needs import errors_of, unmet
from ..errors import CurveboundError, nearest
from .finding import FAILED, Finding, Skipped, Wrong, digest_of, found
from .request import Request

__all__ = ["CHECKS", "SceneCheck"]


class SceneCheck:
    """All checks of the scene `which`, a name or a file; of `request` start, stop, step, most."""

    def __init__(self, which: str, request: Request) -> None:
        self.which = which
        self.request = request
        self.result: Result | None = None
        self._scene: Scene | None = None

    def findings(self, begin: Callable[[str], None] = lambda name: None) -> Iterator[Finding]:
        """Each finding when it is there; begin: told the name of each check before."""
        for name in CHECKS:
            begin(name)
            finding = found(name, partial(self._look, name))
            yield finding
            if finding.outcome == FAILED and self.result is None:
                return

    def _look(self, name: str) -> str:
        look: Callable[[], str] = getattr(self, f"_{name}")
        try:
            return look()
        except CurveboundError as error:
            raise Wrong(str(error)) from error

    def digest(self) -> dict[str, str]:
        """A hash of each recorded output of a run."""
        if self.result is None:
            self._description()
            self._simulation()
        assert self.result is not None
        rows = [self.result[name].astype(float) for name in self.result.names]
        return digest_of(self.result.names, np.stack(rows, axis=1))

    def _description(self) -> str:
        request = self.request
        scene = load_scene(self.which).copy()
        for path, value in request.start.items():
            scene.set(path, value)
        scene.stop_time = request.stop or scene.stop_time
        scene.step = request.step or scene.step
        if scene.recorded or scene.needs.errors:
            scene.record(*scene.needs.errors, *request.most)
        system = scene.check()
        self._scene = scene
        return f"{len(system.nodes)} components, {len(system.links)} connections"

    def _simulation(self) -> str:
        assert self._scene is not None
        try:
            result = self._scene.run()
        except RunFailed as failed:
            raise Wrong(str(failed)) from failed
        for name in result.names:
            if not np.isfinite(result[name].astype(float)).all():
                raise Wrong(f"{name} is no finite number at some time")
        self.result = result
        said = "".join(f"; {note}" for note in result.notes[:1])
        return f"{result.time[-1] - result.time[0]:g} s in {result.steps} steps{said}"

    def _needs(self) -> str:
        assert self._scene is not None
        assert self.result is not None
        needs = self._scene.needs
        if not (needs.errors or needs.budget or needs.frame_rate):
            raise Skipped("the scene states no needs")
        errors = errors_of(self._scene, self.result)
        missed = unmet(self._scene, self.result, errors)
        if missed:
            raise Wrong(" ".join(missed))
        if needs.errors and not errors:
            raise Skipped("no component can solve its equations more exactly (solver.method)")
        return ", ".join(
            f"{path} is off by {error:.1e} {self.result.units.get(path, '1')}, "
            f"{needs.errors[path]:g} is allowed"
            for path, error in errors.items()
        )

    def _bounds(self) -> str:
        assert self.result is not None
        if not self.request.most:
            raise Skipped("no bound was given (--max)")
        told = []
        for path, bound in self.request.most.items():
            if path not in self.result.names:
                raise Wrong(f"{path} is not recorded; {nearest(path, self.result.names)}")
            values = np.abs(self.result[path].astype(float))
            unit = self.result.units.get(path, "")
            told.append(f"{path} reaches {values.max():.3g}, {bound:g} {unit}".rstrip())
            told[-1] += " is allowed"
            if not values.max() <= bound:
                time = float(self.result.time[int(np.flatnonzero(~(values <= bound))[0])])
                raise Wrong(f"{told[-1]} (exceeded first at t = {time:.6g} s)")
        return "; ".join(told)


#: the checks by name, in their order: the method _NAME of SceneCheck does each
CHECKS = ("description", "simulation", "needs", "bounds")
