"""Scenes of one FMU, run by fmpy.simulate_fmu."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np

from .fmu import extracted
from .instance import FATAL, WARNING, Log, status_name
from .prepared import communication_times
from .results import Result, RunFailed
from .scene import Scene
from .system import System, path_of

__all__ = ["is_single", "run_single"]

_BEAT = 0.1  # s of wall time between reports of progress


def is_single(scene: Scene) -> bool:
    """Whether fmpy.simulate_fmu can run it: one component, nothing connected, a fixed step."""
    return (
        len(scene.components) == 1
        and scene.adaptive is None
        and not scene.connections
        and not scene.matches
    )


def run_single(scene: Scene, progress: Callable[[float], None] | None = None) -> Result:
    """Run a scene of one FMU; inputs go through fmpy's `input`, as a table of their values.

    The table holds the inputs at each communication point, so that, as on the masters, each is
    held from its communication point to the next. What fmpy records of an output with direct
    feedthrough still belongs to the input of the step that ends there; the masters record it with
    the input that holds from there on. Raises RunFailed.
    """
    from fmpy.fmi1 import FMICallException
    from fmpy.simulation import instantiate_fmu, simulate_fmu

    began = clock.perf_counter()
    system = scene.check()
    (node,) = system.nodes.values()
    fmu = node.fmu
    log = Log()
    rows: list[Any] = []
    columns: list[Any] = []
    next_beat = [began + _BEAT]

    def follow(time: float, recorder: Any) -> bool:
        if not columns:  # keep hold of what is recorded, in case of a failure
            rows.append(recorder.rows)
            columns.extend(recorder.cols)
        if progress is not None and clock.perf_counter() > next_beat[0]:
            next_beat[0] = clock.perf_counter() + _BEAT
            progress(time)
        return True

    variables = [port[1] for port in system.recorded]
    start = {k: v for k, v in node.start.items() if (node.name, k) not in system.signals}
    instance = instantiate_fmu(
        str(extracted(fmu)), fmu.description, "CoSimulation", debug_logging=True, logger=log.write
    )
    failure = ""
    alive = True
    try:
        data = simulate_fmu(
            str(extracted(fmu)),
            validate=False,
            fmu_instance=instance,
            model_description=fmu.description,
            start_time=scene.start_time,
            stop_time=scene.stop_time,
            output_interval=scene.step,
            relative_tolerance=scene.tolerance,
            start_values=start,
            input=_table(system),
            output=variables,
            step_finished=follow,
        )
        reached = float(data["time"][-1])
        if reached < scene.stop_time - 1e-9 * max(1.0, abs(scene.stop_time)):
            failure = _cause(log, "fmi2DoStep returned fmi2Discard: the FMU ended the simulation")
    except FMICallException as error:
        alive = error.status < FATAL
        failure = _cause(log, f"{error.function} returned {status_name(error.status)}")
        data = np.array(rows[0] if rows else [], dtype=np.dtype(columns or [("time", float)]))
    finally:
        if alive:
            with suppress(Exception):
                instance.freeInstance()
    return _result(system, data, failure, began, log)


def _cause(log: Log, otherwise: str) -> str:
    said = next((t for _, status, t in reversed(log.entries) if status > WARNING and t), "")
    return otherwise + (f": {said}" if said else "")


def _table(system: System) -> Any:
    """fmpy's input: a structured array over the communication points, or None without inputs."""
    if not system.signals:
        return None
    times = communication_times(system.scene)
    (node,) = system.nodes.values()
    table = {"time": times}
    for name in node.fmu.inputs:  # fmpy prints a warning for each input that is not in the table
        variable = node.fmu.variables[name]
        if variable.kind == "String":
            continue
        constant = node.start.get(name, variable.start or 0.0)
        table[name] = [float(variable.value(constant))] * len(times)
    for (_, name), function in system.signals.items():
        table[name] = [float(function(t)) for t in times]
    array = np.zeros(len(times), dtype=[(name, np.float64) for name in table])
    for name, values in table.items():
        array[name] = values
    return array


def _result(system: System, data: Any, failure: str, began: float, log: Log) -> Result:
    scene = system.scene
    (node,) = system.nodes.values()
    names = set(data.dtype.names)
    ports = [port for port in system.recorded if port[1] in names]
    kept = data
    if scene.record_every > 1 and len(data):
        index = np.arange(0, len(data), scene.record_every)
        if index[-1] != len(data) - 1:
            index = np.append(index, len(data) - 1)
        kept = data[index]
    table = np.zeros(len(kept), dtype=system.row_type(ports))
    table["time"] = kept["time"]
    for port in ports:
        table[path_of(port)] = kept[port[1]]
    steps = max(0, len(data) - 1)
    result = Result(
        scene=scene.name,
        data=table,
        wall=clock.perf_counter() - began,
        steps=steps,
        trials=steps,
        units=system.units(ports),
        drawings=system.drawings(),
        notes=[*system.notes, *(f"{node.name}: {t}" for _, s, t in log.entries if s == WARNING)],
        settings={"algorithm": "fmpy.simulate_fmu", "step": scene.step, "adaptive": False},
    )
    result.stepping = result.wall
    if failure:
        time = float(data["time"][-1]) if len(data) else scene.start_time
        result.complete = False
        result.failure = (
            f"The scene {scene.name} failed at t = {time:.6g} s: component {node.name}: {failure}"
        )
        raise RunFailed(result.failure, result, node.name, time, failure)
    return result
