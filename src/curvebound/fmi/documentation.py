"""The documentation that an FMU carries: documentation/index.html, licences, reference result."""

from __future__ import annotations

from html import escape
from importlib.metadata import distribution

from .. import __version__
from ..cells import defused
from ..pages import Html, report, table
from ..places import license_text
from .declaration import CHOICE, COUNT, COUNT_PARAMETER, INPUT, OUTPUT, PARAMETER, Fmu, Variable
from .folder import Folder
from .reference import ReferenceResult, reference_result

__all__ = ["csv_text", "documentation_files"]

#: colours that the colour-blind can tell apart (Okabe and Ito 2008)
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")


def documentation_files(folder: Folder) -> dict[str, bytes]:
    """The page, the reference result, licences, icon and pictures: path in the FMU -> content.

    Without a reference where not all variables are described: that is of all outputs by themselves.
    """
    fmu = folder.fmu()
    result = None if fmu.shown else reference_result(fmu)
    files = {
        "documentation/index.html": _page(fmu, folder.documentation(), result).encode(),
        "documentation/licenses/license.txt": _licences().encode(),
    }
    if result is not None:
        files["documentation/reference.csv"] = csv_text(result.outputs).encode()
        if len(result.inputs) > 1:
            files["documentation/reference_inputs.csv"] = csv_text(result.inputs).encode()
    icon = folder.path / "icon.png"
    if icon.is_file():
        files["model.png"] = icon.read_bytes()
    for picture in sorted(folder.path.glob("*.svg")):
        files[f"documentation/{picture.name}"] = picture.read_bytes()
    return files


def csv_text(columns: dict[str, list[float]]) -> str:
    """Comma-separated columns under a line of their names; floats keep every digit."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(f'"{defused(name)}"' for name in columns)]
    lines += [",".join(repr(x) for x in row) for row in rows]
    return "\n".join(lines) + "\n"


def _licences() -> str:
    parts = [
        "curvebound, which this FMU was built with and whose code it carries:\n",
        license_text(),
    ]
    for file in distribution("pythonfmu").files or ():
        if file.name == "LICENSE":
            parts += ["\nPythonFMU, parts of which it carries:\n", file.read_text()]
    return "\n".join(parts)


def _page(fmu: Fmu, told: str, result: ReferenceResult | None) -> str:
    name = escape(fmu.name)
    reference = ""
    if result is not None:
        reference = f"""<h2>Reference result</h2>
<p>{_experiment(fmu)} The samples are in <a href="reference.csv">reference.csv</a>.</p>
{_plot(fmu, result)}"""
    body = f"""<header><h1>{name}</h1>
<p>{escape(fmu.description)}. FMI 2.0 for co-simulation, curvebound {__version__}, MIT licence
(<a href="licenses/license.txt">text</a>).</p></header>
<main>
{told.strip()}
<h2>Parameters</h2>
{_variables(fmu, (PARAMETER, CHOICE, COUNT_PARAMETER))}
<h2>Inputs</h2>
<p>Held over a communication step; linear in time over it where the importer gives slopes and
<code>canInterpolateInputs</code> is true.</p>
{_variables(fmu, (INPUT,))}
<h2>Outputs</h2>
<p>Where <code>providesDirectionalDerivative</code> is true, fmi2GetDirectionalDerivative tells how
they change with the inputs of the same instant.</p>
{_variables(fmu, (OUTPUT, COUNT))}
{reference}
</main>"""
    return report(fmu.name, body)


def _experiment(fmu: Fmu) -> str:
    text = f"{fmu.stop_time:g} s in communication steps of {fmu.step_size:g} s"
    if fmu.reference_inputs:
        given = ", ".join(
            f"{name} = {_signal(value)}" for name, value in fmu.reference_inputs.items()
        )
        text += f', with {given} (<a href="reference_inputs.csv">reference_inputs.csv</a>)'
    text += (
        " from the default start values. At each communication point the outputs are read, then "
        "the inputs of that point set and held over the step; those of the first are set in "
        "initialization mode too"
    )
    return text + ", integrated to a relative tolerance of 1e-13."


def _signal(value: float | str | tuple[float, float]) -> str:
    if isinstance(value, tuple):
        amplitude, frequency = value
        return f"{amplitude:g} sin(2&pi; {frequency:g} t)"
    return value if isinstance(value, str) else f"{value:g}"


def _variables(fmu: Fmu, kinds: tuple[str, ...]) -> str:
    rows = [v for _, v in fmu.described() if v.kind in kinds]
    if not rows:
        return "<p>None.</p>"
    if INPUT in kinds or OUTPUT in kinds:
        named = [[v.name, v.unit, Html(_meaning(v))] for v in rows]
        return table(["name", "unit", "meaning"], named, words=(0, 1, 2))
    given = [[v.name, v.unit, _start(v), Html(_meaning(v))] for v in rows]
    return table(["name", "unit", "start", "meaning"], given, words=(0, 1, 3))


def _start(variable: Variable) -> str:
    if variable.type:
        return variable.type.items[int(variable.start) - 1][0]
    return f"{variable.start:g}"


def _meaning(variable: Variable) -> str:
    meaning = escape(variable.description)
    if variable.type:
        meaning += ": " + "; ".join(
            f"{i} <b>{escape(item)}</b>, {escape(text)}"
            for i, (item, text) in enumerate(variable.type.items, 1)
        )
    return meaning + (" (tunable)" if variable.tunable else "")


def _plot(fmu: Fmu, result: ReferenceResult) -> str:
    """The outputs named in the declaration, one panel each, as SVG."""
    width, height, left, gap = 720, 130, 90, 34
    panels = []
    end = result.time[-1]
    for number, name in enumerate(fmu.plotted):
        values = result.outputs[name]
        low, high = min(values), max(values)
        span = (high - low) or 1.0
        top = number * (height + gap) + 20
        points = " ".join(
            f"{left + (width - left) * t / end:.1f},{top + height * (high - x) / span:.1f}"
            for t, x in zip(result.time, values, strict=True)
        )
        unit = next(v.unit for v in fmu.variables if v.name == name)
        colour = _COLOURS[number % len(_COLOURS)]
        panels.append(
            f'<text x="{left}" y="{top - 6}">{escape(name)} / {escape(unit)}</text>'
            f'<text x="{left - 8}" y="{top + 10}" text-anchor="end">{high:.3g}</text>'
            f'<text x="{left - 8}" y="{top + height}" text-anchor="end">{low:.3g}</text>'
            f'<rect x="{left}" y="{top}" width="{width - left}" height="{height}" fill="none" '
            f'stroke="#999"/><polyline points="{points}" fill="none" stroke="{colour}" '
            'stroke-width="1.5"/>'
        )
    total = len(fmu.plotted) * (height + gap) + 26
    axis = (
        f'<text x="{left}" y="{total - 6}">0</text>'
        f'<text x="{width}" y="{total - 6}" text-anchor="end">{end:g} s</text>'
    )
    return (
        f'<svg viewBox="0 0 {width + 4} {total}" width="{width}" role="img" font-size="12" '
        f'font-family="sans-serif" aria-label="reference result">{"".join(panels)}{axis}</svg>'
    )
