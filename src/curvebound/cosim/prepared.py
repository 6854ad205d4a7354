"""A scene made ready: FMUs loaded and instantiated once, run as often as wanted."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress

from ..errors import CurveboundError, nearest
from ..numbers import plain
from .adaptive import adaptive_steps
from .algorithms import advance_of
from .counters import Counters
from .exchange import Exchange
from .fmu import Value
from .instance import CallFailed, Ended, Instance, Library, Log
from .loops import LoopFailed
from .points import count_steps, macro_steps
from .recording import Recording
from .resolution import resolve
from .results import Result, RunFailed, RunInterrupted
from .scene_data import SceneData
from .schedule import Schedule
from .system import port_of

__all__ = ["Prepared"]

Progress = Callable[[float], None]
_BEAT = 0.1  # s of wall time between reports of progress


class Prepared:
    """The FMUs of a scene, loaded. Use as a context manager, or call `close`.

    Instances live from the first run to `close`, and are reset between runs; after a failed run
    they are freed, and made anew by the next.
    """

    def __init__(self, scene: SceneData) -> None:
        self.scene = scene
        self.system = resolve(scene)
        self.log = Log()
        self.exchange = Exchange(self.system)
        self._libraries: dict[str, Library] = {}
        self._instances: dict[str, Instance] = {}
        self._schedule: Schedule | None = None

    def __enter__(self) -> Prepared:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Terminate and free every instance and unload the FMUs."""
        self._free()
        for library in self._libraries.values():
            library.unload()
        self._libraries.clear()

    def _free(self) -> None:
        self._schedule = None
        self.exchange.forget_calls()
        for instance in self._instances.values():
            instance.free()
        self._instances.clear()

    def run(
        self,
        start: Mapping[str, Value] | None = None,
        *,
        stop_time: float | None = None,
        step: float | None = None,
        progress: Progress | None = None,
    ) -> Result:
        """Run from the start time.

        start: start values by path, on top of the scene's, for this run only.
        stop_time, step: instead of the scene's, in s.
        A component that asks to end the simulation ends it; a note says which, and when. Raises
        RunFailed, and RunInterrupted on Ctrl-C, with what was recorded until then; the next run
        works again.
        """
        began = clock.perf_counter()
        values = self._start_values(start or {})
        begin = self.scene.start_time
        end = self.scene.stop_time if stop_time is None else stop_time
        size = self.scene.step if step is None else step
        self._require_times(begin, end, size)
        every = self.scene.record_every
        rows = 1024
        if self.scene.adaptive is None:
            rows = count_steps(begin, end, size)[0] // every + 3
        recording = self._recording(rows)
        counters = Counters()
        self.log.clear()
        notes: list[str] = []
        reached = begin
        try:
            schedule = self._ready(values, begin, end)
            stepping = clock.perf_counter()
            recording.keep(begin)
            next_beat = stepping + _BEAT
            kept = True
            steps = self._steps(schedule, begin, end, size, counters)
            try:
                for reached, index in steps:
                    kept = every == 1 or index % every == 0
                    if kept:
                        recording.keep(reached)
                    if progress is not None and clock.perf_counter() > next_beat:
                        next_beat = clock.perf_counter() + _BEAT
                        progress(reached)
                if not kept:
                    recording.keep(reached)
            except Ended as ending:
                self._keep_last(ending, recording, reached, kept)
                said = f": {ending.said}" if ending.said else ""
                notes.append(f"The component {ending}{said}.")
            stepped = clock.perf_counter() - stepping
            for instance in self._instances.values():
                instance.terminate()
        except CallFailed as error:
            failure = (error.component, error.cause)
            raise self._failed(recording, counters, began, reached, *failure) from error
        except (LoopFailed, FloatingPointError) as error:
            raise self._failed(recording, counters, began, reached, "", str(error)) from error
        except KeyboardInterrupt as error:
            failed = self._failed(recording, counters, began, reached, "", "interrupted")
            raise RunInterrupted(failed) from error
        except BaseException:
            self._free()
            raise
        result = self._result(recording, counters, began)
        result.notes += notes
        result.stepping = stepped
        result.settings["step"] = size
        if progress is not None:
            progress(end)
        return result

    def _recording(self, rows: int) -> Recording:
        try:
            return Recording(self.system, self.exchange, rows)
        except (MemoryError, ValueError) as error:  # numpy's, of what is too much for any memory
            raise CurveboundError(
                f"{plain(rows)} points of the scene {self.scene.name} do not fit into memory: take "
                "a longer step or a shorter run, record less, or only each n-th point "
                "(record_every)."
            ) from error

    def _require_times(self, begin: float, end: float, step: float) -> None:
        if not end > begin:
            raise CurveboundError(
                f"stop_time is {end} s; give one after start_time, {begin} s, of the scene "
                f"{self.scene.name}."
            )
        if not step > 0.0:
            raise CurveboundError(
                f"step is {step} s; give the scene {self.scene.name} a macro step above zero."
            )
        largest = max(begin, end, key=abs)
        if largest - step == largest:
            raise CurveboundError(
                f"step is {step} s, which rounding loses beside the time {largest} s: give the "
                f"scene {self.scene.name} a longer one."
            )

    def _steps(
        self, schedule: Schedule, begin: float, end: float, size: float, counters: Counters
    ) -> Iterator[tuple[float, int]]:
        """Advance; each communication point reached, evaluated, with the number of its macro step.

        -1 stands for the number of a point at which a jump cuts a macro step.
        """
        if self.scene.adaptive is not None:
            points = adaptive_steps(schedule, begin, end, size, counters)
            for number, reached in enumerate(points, 1):
                yield reached, number
            return
        advance = advance_of(schedule)
        evaluate = schedule.evaluate
        number = 0
        for time, duration, reached, whole in macro_steps(begin, end, size, self.system.stops):
            advance(time, duration)
            evaluate(reached)
            counters.steps += 1
            counters.trials += 1
            number += whole
            yield reached, number if whole else -1

    def _keep_last(self, end: Ended, recording: Recording, reached: float, kept: bool) -> None:
        """Record where a component ended the simulation, in a scene of one.

        In a scene of several the others have not all reached that time: their last communication
        point is the last that is consistent.
        """
        if len(self._instances) > 1 or self._schedule is None:
            return
        if not kept:
            recording.keep(reached)
        if end.time > reached:
            with suppress(CallFailed, Ended):
                self._schedule.read_all(end.component)
                recording.keep(end.time)

    # set-up

    def _start_values(self, extra: Mapping[str, Value]) -> dict[str, dict[str, Value]]:
        values = {name: dict(node.start) for name, node in self.system.nodes.items()}
        for path, given in extra.items():
            name, variable = port_of(path)
            node = self.system.nodes.get(name)
            known = None if node is None else node.fmu.variables.get(variable)
            if known is None or not known.is_settable_start:
                known_paths = [
                    f"{name}.{v.name}"
                    for name, node in self.system.nodes.items()
                    for v in node.fmu.variables.values()
                    if v.is_settable_start
                ]
                raise CurveboundError(
                    f"{path} is no variable of the scene {self.scene.name} that takes a start "
                    f"value; {nearest(path, known_paths)}"
                )
            try:
                values[name][variable] = known.value(given)
            except ValueError as error:
                raise CurveboundError(f"{path}: {error}") from None
        return values

    def _ready(self, values: dict[str, dict[str, Value]], begin: float, end: float) -> Schedule:
        """Instances initialized with `values`, at a consistent initial point."""
        if not all(instance.reset() for instance in self._instances.values()):
            self._free()
        for name, node in self.system.nodes.items():
            if name not in self._instances:
                path = str(node.fmu.path)
                library = self._libraries.get(path)
                if library is None:
                    library = self._libraries[path] = Library(node.fmu)
                self._instances[name] = Instance(name, library, self.log)
        if self._schedule is None:
            self._schedule = Schedule(self.system, self.exchange, self._instances)
        for name, instance in self._instances.items():
            tolerance = self.scene.tolerance
            if tolerance is None:
                tolerance = self.system.nodes[name].fmu.tolerance
            instance.initialize(values[name].items(), tolerance, begin, end)
        self._schedule.initialize(begin)
        for instance in self._instances.values():
            instance.call("ExitInitializationMode")
        self._schedule.read_states()
        self._schedule.evaluate(begin)
        return self._schedule

    # results

    def _result(self, recording: Recording, counters: Counters, began: float) -> Result:
        data = recording.table()
        return Result(
            scene=self.scene.name,
            data=data,
            wall=clock.perf_counter() - began,
            steps=counters.steps,
            trials=counters.trials,
            rejected=counters.rejected,
            units=self.system.units(self.system.recorded),
            drawings=self.system.drawings(),
            inputs=self.system.acting(data),
            notes=[*self.system.notes, *self.log.warnings(), *_forced(counters)],
            settings={
                "algorithm": self.scene.algorithm,
                "hold": self.scene.hold,
                "step": self.scene.step,
                "adaptive": self.scene.adaptive is not None,
            },
        )

    def _failed(
        self,
        recording: Recording,
        counters: Counters,
        began: float,
        time: float,
        component: str,
        cause: str,
    ) -> RunFailed:
        """Free everything, the sound components terminated before; the error to raise."""
        self._free()  # before the result: a component may say something at its end
        result = self._result(recording, counters, began)
        who = f"component {component}: " if component else ""
        message = f"The scene {self.scene.name} failed at t = {time:.6g} s: {who}{cause}"
        result.complete = False
        result.failure = message
        return RunFailed(message, result, component, time, cause)


def _forced(counters: Counters) -> list[str]:
    if not counters.forced:
        return []
    return [
        f"{counters.forced} macro steps were at their lower bound with an error above the "
        f"tolerance, up to {counters.excess:.2g} times as large: name the times at which inputs "
        "jump, lower adaptive.smallest, or take an algorithm of second order (midpoint, strang)."
    ]
