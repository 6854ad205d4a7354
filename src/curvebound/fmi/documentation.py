"""The documentation that an FMU carries: documentation/index.html, licences, reference result."""

from __future__ import annotations

import re
import zipfile
from html import escape
from importlib.metadata import distribution
from pathlib import Path

from .. import __version__
from ..cells import defused
from ..files import write_whole
from ..numbers import plain
from ..pages import Html, report, table
from ..places import license_text
from .declaration import CHOICE, COUNT, COUNT_PARAMETER, INPUT, OUTPUT, PARAMETER, Fmu, Variable
from .drawing import Drawing
from .folder import Folder
from .reference import ReferenceResult, reference_result
from .reference_plot import reference_plots
from .sketch import Sketch, sketch_of

__all__ = ["csv_text", "documentation_files", "unpack_documentation"]


def documentation_files(folder: Folder, drawing: Drawing) -> dict[str, bytes]:
    """The page, the reference result, licences, icon and pictures: path in the FMU -> content.

    drawing: that of the folder, which is sketched.
    Without a reference where not all variables are described: that is of all outputs by themselves.
    """
    fmu = folder.fmu()
    result = None if fmu.shown else reference_result(fmu)
    files = {
        "documentation/index.html": _page(folder, fmu, drawing, result).encode(),
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


def unpack_documentation(fmu: Path, folder: Path) -> Path:
    """Write the documentation in a built FMU into `folder`; its page."""
    with zipfile.ZipFile(fmu) as archive:
        for name in archive.namelist():
            if name.startswith("documentation/"):
                data = archive.read(name)
                out = folder / name.removeprefix("documentation/")
                write_whole(out, lambda path, data=data: path.write_bytes(data))  # type: ignore[misc]
    return folder / "index.html"


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


def _page(folder: Folder, fmu: Fmu, drawing: Drawing, result: ReferenceResult | None) -> str:
    name = escape(fmu.name)
    reference = ""
    if result is not None:
        reference = f"""<h2>Reference result</h2>
<p>{_experiment(fmu, result)} The samples are in <a href="reference.csv">reference.csv</a>.</p>
{reference_plots(fmu, result)}"""
    body = f"""<header><h1>{name}</h1>
<p>{escape(fmu.description)}. FMI 2.0 for co-simulation, curvebound {__version__}, MIT licence
(<a href="licenses/license.txt">text</a>).</p></header>
<main>
{_sketch(folder, drawing, result)}
{folder.documentation().strip()}
<h2>Parameters</h2>
{_variables(fmu, (PARAMETER, CHOICE, COUNT_PARAMETER))}
<h2>Inputs</h2>
<p>Held over a communication step; linear in time over it where the importer gives slopes and
<code>canInterpolateInputs</code> is true. They stay where slopes have led them.</p>
{_variables(fmu, (INPUT,))}
<h2>Outputs</h2>
<p>Where <code>providesDirectionalDerivative</code> is true, fmi2GetDirectionalDerivative tells how
they change with the inputs of the same instant.</p>
{_variables(fmu, (OUTPUT, COUNT))}
{reference}
</main>"""
    return report(fmu.name, body)


def _sketch(folder: Folder, drawing: Drawing, result: ReferenceResult | None) -> str:
    """The sketch with its symbols explained; nothing where there is no pose to draw."""
    marks = folder.sketch(drawing)
    if marks is None and result is None:
        return ""
    marks = marks or Sketch()
    start = {name: column[0] for name, column in result.outputs.items()} if result else {}
    svg = sketch_of(drawing, marks, start)
    if not svg:
        return ""
    words = ", ".join(
        f"<i>{escape(symbol)}</i>&nbsp;{escape(name)}" for name, symbol in marks.symbols.items()
    )
    return f"<figure>{svg}<figcaption>{words}</figcaption></figure>"


def _experiment(fmu: Fmu, result: ReferenceResult) -> str:
    text = f"{plain(fmu.stop_time)} s in communication steps of {plain(fmu.step_size)} s"
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
    text += ", integrated to a relative tolerance of 1e-13."
    if result.doubts:
        # without its advice, which is about tolerances that the reader cannot set here
        reason = re.split("[;:] ", result.doubts[0])[0]
        text += f" It is less exact than that: {escape(reason)}."
    return text


def _signal(value: float | str | tuple[float, float]) -> str:
    if isinstance(value, tuple):
        amplitude, frequency = value
        return f"{plain(amplitude)} sin(2&pi; {plain(frequency)} t)"
    return value if isinstance(value, str) else plain(value)


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
    return plain(variable.start, 6)


def _meaning(variable: Variable) -> str:
    meaning = escape(variable.description)
    if variable.type:
        meaning += ": " + "; ".join(
            f"{i} <b>{escape(item)}</b>, {escape(text)}"
            for i, (item, text) in enumerate(variable.type.items, 1)
        )
    return meaning + (" (tunable)" if variable.tunable else "")
