"""What every page of one live scene shares: the scene as it is stepped, and what may be changed."""

from __future__ import annotations

from collections.abc import Mapping

from ...cosim import Result, RunFailed, Scene
from ...cosim.fmu import Value
from ...cosim.prepared import Prepared
from ...cosim.system import port_of
from ...errors import CurveboundError
from ..reading import with_inputs
from .controls import OWN_SETTINGS, controls_of, grips_of, settings_of
from .driven import Driven

__all__ = ["Plan"]

_MOST_STEPS = 20_000  # of the run beforehand


class Plan:
    """A scene for the page.

    scene: recording all outputs, with a fixed macro step. system: the same, resolved.
    controls, settings: what may be changed while it runs, and with a restart, by path.
    shown: the controls that drawings show as arrows, by path: the page is told their values too.
    seen: a run of the scene as it is, from which the page takes the part of the plane to show.
    notes: what the page should say at first. Raises CurveboundError where the scene is wrong.
    """

    def __init__(self, scene: Scene) -> None:
        self.notes: list[str] = []
        self.scene = scene.copy()
        if scene.adaptive is not None:
            self.notes.append(
                "The scene chooses its macro steps; here they are all of its step, "
                f"{scene.step:g} s."
            )
            self.scene.adaptive = None
        nodes = scene.check().nodes
        self.scene.record(*(f"{name}.*" for name, node in nodes.items() if node.fmu.outputs))
        self.can_go_back = all(node.fmu.can_roll_back for node in nodes.values())
        self.scene.goes_back = self.can_go_back
        self.system = self.scene.check()
        self.controls = {control.path: control for control in controls_of(self.system)}
        self.settings = {control.path: control for control in settings_of(self.system)}
        self.grips = grips_of(self.system)
        drawings = self.system.drawings()
        arrows = {f"{name}.{one}" for name in drawings for one in drawings[name].of_arrows()}
        self.shown = [path for path in self.controls if path in arrows]
        self.seen = with_inputs(self._look())
        driven = self.driven({path: float(one.value) for path, one in self.controls.items()})
        self.notes += self.stepped({}, driven)[0].check().notes

    def _look(self) -> Result:
        scene = self.scene.copy()
        scene.stop_time = min(scene.stop_time, scene.start_time + _MOST_STEPS * scene.step)
        try:
            with Prepared(scene) as prepared:
                return prepared.run()
        except RunFailed as error:
            if not len(error.result.data):
                raise
            self.notes.append(str(error))
            return error.result

    def driven(self, values: Mapping[str, float]) -> dict[str, Driven]:
        """What drives every control from the start on, held at `values`, by path."""
        signals = {".".join(port): given for port, given in self.system.signals.items()}
        begin = self.scene.start_time
        return {path: Driven(values[path], begin, signals.get(path)) for path in self.controls}

    def given(self, path: str) -> Value:
        """What the scene itself gives for a setting."""
        if path in OWN_SETTINGS:
            value: Value = getattr(self.scene, path)
            return value
        for known in (self.settings, self.controls):
            if path in known:
                return known[path].value
        raise CurveboundError(f"{path} is no setting of the scene {self.scene.name}.")

    def variant(self, name: str) -> dict[str, Value]:
        """The settings of a variant of the scene, by path."""
        if name not in self.scene.variants:
            raise CurveboundError(f"The scene {self.scene.name} has no variant {name!r}.")
        return dict(self.scene.variants[name])

    def stepped(
        self, settings: Mapping[str, Value], driven: dict[str, Driven]
    ) -> tuple[Scene, dict[str, Driven]]:
        """The scene with other settings, by path, and what drives it.

        A setting of what is driven is held instead of the value that `driven` has.
        """
        scene = self.scene.copy()
        own = dict(driven)
        begin = scene.start_time
        for path, value in settings.items():
            if path in self.controls:
                variable = self.system.variable(port_of(path))
                try:
                    own[path] = Driven(float(variable.value(value)), begin)
                except ValueError as error:
                    raise CurveboundError(f"{path}: {error}") from None
            else:
                self.given(path)
                scene.set(path, value)
        scene.inputs.update(own)
        return scene, own
