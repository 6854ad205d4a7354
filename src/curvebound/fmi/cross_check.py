"""The layout of the FMI Cross-Check: FMU, reference result, inputs, options and bounds."""

from __future__ import annotations

import shutil
from pathlib import Path

from .build import build
from .declaration import Fmu
from .documentation import csv_text
from .folder import find
from .reference import TOLERANCE, ReferenceResult, reference_result

__all__ = ["write_cross_check"]

#: a bound is this many times the error that the default solver settings make
MARGIN = 10.0
#: and no less than this, relative to the largest value: summation order, other math libraries
FLOOR = 1e-12

_README = """\
{name}: {description}

{name}_ref.csv  outputs of the default experiment at each communication point, integrated to a
                relative tolerance of {tolerance:g}: the solution of the equations to rounding
{name}_in.csv   the inputs, and tunable parameters that are set like them, to be held constant
                from each of its times to the next; enumerations by number
{name}_ref.opt  start and stop time, communication step (s); RelTol is the largest relative bound
{name}_bounds.csv  for each output the largest error (in its unit) that an importer's result with
                the FMU's default settings may have: {margin:g} times the error measured there
                when this folder was written, which is that of rk4 with solver.step = 1e-3 s

Start values are the FMU's defaults. The order at each communication point: read the outputs, set
the inputs of that time, make the step. The inputs of the first are set in initialization mode too.
That is the order of fmpy:

    fmpy.simulate_fmu("{name}.fmu", stop_time={stop:g}, output_interval={step:g}{signals})
"""


def write_cross_check(name: str, out: Path, *, compiled: bool = True) -> Path:
    """Write the folder OUT/NAME; returns it. It appears whole: a failure leaves the old one."""
    folder = find(name)
    fmu = folder.fmu()
    name = fmu.name
    target = out / name
    scratch = out / f".{name}.part"
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    try:
        build(folder, scratch, compiled=compiled)
        exact = reference_result(fmu)
        bounds = _bounds(exact, reference_result(fmu, exact=False))
        _write_text(scratch, fmu, exact, bounds)
        shutil.rmtree(target, ignore_errors=True)
        scratch.rename(target)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return target


def _bounds(exact: ReferenceResult, usual: ReferenceResult) -> dict[str, float]:
    bounds = {}
    for name, values in exact.outputs.items():
        if name != "time":
            pairs = zip(values, usual.outputs[name], strict=True)
            error = max(abs(a - b) for a, b in pairs)
            bounds[name] = max(MARGIN * error, FLOOR * max(1.0, *(abs(x) for x in values)))
    return bounds


def _write_text(folder: Path, fmu: Fmu, exact: ReferenceResult, bounds: dict[str, float]) -> None:
    (folder / f"{fmu.name}_ref.csv").write_text(csv_text(exact.outputs))
    if len(exact.inputs) > 1:
        (folder / f"{fmu.name}_in.csv").write_text(csv_text(exact.inputs))
    scale = {n: max(1e-3, *(abs(x) for x in v)) for n, v in exact.outputs.items()}
    relative = max(bound / scale[name] for name, bound in bounds.items())
    (folder / f"{fmu.name}_ref.opt").write_text(
        f"StartTime, 0.0\nStopTime, {fmu.stop_time!r}\nStepSize, {fmu.step_size!r}\n"
        f"RelTol, {relative:.1e}\nOutputIntervalLength, {fmu.step_size!r}\n"
    )
    rows = "".join(f'"{name}",{bound!r}\n' for name, bound in bounds.items())
    (folder / f"{fmu.name}_bounds.csv").write_text("output,bound\n" + rows)
    (folder / "README.txt").write_text(
        _README.format(
            name=fmu.name,
            description=fmu.description,
            tolerance=TOLERANCE,
            margin=MARGIN,
            stop=fmu.stop_time,
            step=fmu.step_size,
            signals=f', input=fmpy.read_csv("{fmu.name}_in.csv")' if fmu.reference_inputs else "",
        )
    )
