"""Whose GUID an FMU takes: guid.txt beside its library, else that of modelDescription.xml."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

HEADS = (
    '<fmiModelDescription guid="{g}" fmiVersion="2.0">',
    "<fmiModelDescription fmiVersion='2.0'\n\t guid='{g}'>",
    '<fmiModelDescription\r\n  modelName="the guid=1 of" other-guid="x"   guid = "{g}" a="b">',
    '<fmiModelDescription xguid="x" guidx="y" GUID="z" guid="{g}">',
)


@pytest.mark.parametrize("head", HEADS, ids=range(len(HEADS)))
def test_guid_of_the_description(
    head: str, host: Callable[..., Any], bead: Any, copy_of: Callable[[Any, str], Any],
    system_python: None,
) -> None:  # fmt: skip
    fmu = copy_of(bead, "copy")
    guid = fmu.binary.with_name("guid.txt")
    assert guid.read_text().strip() == fmu.guid
    guid.unlink()
    file = fmu.folder / "modelDescription.xml"
    text = re.sub("<fmiModelDescription[^>]*>", lambda _: head.format(g=fmu.guid), file.read_text())
    file.write_bytes(text.encode())
    other = fmu.guid.replace(fmu.guid[5], "0" if fmu.guid[5] != "0" else "1")
    wrong = [f"new {k} 0 i{k} {given} {fmu.uri} 0" for k, given in ((1, other), (2, fmu.guid[:-1]))]
    answers = host([*fmu.start(), *wrong]).answers
    assert answers[1] == ["OK"]
    assert ["OK"] not in answers[2:]


def test_guid_txt_prevails_and_none_takes_any(
    host: Callable[..., Any], bead: Any, copy_of: Callable[[Any, str], Any], system_python: None
) -> None:
    fmu = copy_of(bead, "copy")
    text = fmu.binary.with_name("guid.txt")
    text.write_text("{other}\r\nmore\n")
    new = "new {k} 0 i{k} {g} {uri} 0"
    given = [new.format(k=k, g=g, uri=fmu.uri) for k, g in ((0, fmu.guid), (1, "{other}"))]
    answers = host([f"load 0 {fmu.binary}", *given]).answers
    assert answers[1] != ["OK"]
    assert answers[2] == ["OK"]
    text.unlink()
    (fmu.folder / "modelDescription.xml").unlink()
    assert host([f"load 0 {fmu.binary}", given[0]]).answers[1] == ["OK"]
