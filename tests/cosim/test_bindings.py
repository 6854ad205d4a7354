"""Which of the values prevails that the systems of a package give one parameter."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from descriptions import BARE

from curvebound.cosim import load_scene

HEAD = (
    '<ssd:SystemStructureDescription version="1.0" name="s" '
    'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" '
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" '
    'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">'
)


def binding(**values: float) -> str:
    """Parameters, dots in their names as double underscores."""
    given = "".join(
        f'<ssv:Parameter name="{name.replace("__", ".")}"><ssv:Real value="{value}"/>'
        "</ssv:Parameter>"
        for name, value in values.items()
    )
    if not given:
        return ""
    return (
        "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
        f'<ssv:ParameterSet version="1.0" name="p"><ssv:Parameters>{given}</ssv:Parameters>'
        "</ssv:ParameterSet></ssd:ParameterValues></ssd:ParameterBinding>"
        "</ssd:ParameterBindings>"
    )


def nested(levels: list[str], own: str) -> str:
    """A system in a system, and so on, each with its bindings, and the FMU in the innermost."""
    inside = f'<ssd:Component name="one" source="resources/bare.fmu">{own}</ssd:Component>'
    for depth, bindings in reversed(list(enumerate(levels))):
        inside = (
            f'<ssd:System name="s{depth}">{bindings}<ssd:Elements>{inside}</ssd:Elements>'
            "</ssd:System>"
        )
    return (
        f'{HEAD}{inside}<ssd:DefaultExperiment startTime="0" stopTime="1"/>'
        "</ssd:SystemStructureDescription>"
    )


@pytest.mark.parametrize(
    ("top", "middle", "inner", "own", "expected"),
    [
        (4.0, 3.0, 2.0, 1.0, 4.0),
        (None, 3.0, 2.0, 1.0, 3.0),
        (None, None, 2.0, 1.0, 2.0),
        (None, None, None, 1.0, 1.0),
        (4.0, None, None, 1.0, 4.0),
        (4.0, None, 2.0, None, 4.0),
        (None, 3.0, None, 1.0, 3.0),
    ],
)
def test_the_outermost_prevails(
    top: float | None, middle: float | None, inner: float | None, own: float | None,
    expected: float, tmp_path: Path,
) -> None:  # fmt: skip
    names = {"s1__s2__one__u": top, "s2__one__u": middle, "one__u": inner}
    levels = [binding(**{k: v} if v is not None else {}) for k, v in names.items()]
    path = tmp_path / "s.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        text = nested(levels, binding(u=own) if own is not None else "")
        archive.writestr("SystemStructure.ssd", text)
        with zipfile.ZipFile(tmp_path / "bare.fmu", "w") as fmu:
            fmu.writestr("modelDescription.xml", BARE)
        archive.write(tmp_path / "bare.fmu", "resources/bare.fmu")
    (component,) = load_scene(path).components.values()
    assert component.start == {"u": expected}
