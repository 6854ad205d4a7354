"""Reports in the XML that CI systems read test results in."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from .finding import FAILED, SKIPPED, Report

__all__ = ["junit"]


def junit(reports: Sequence[Report]) -> bytes:
    """JUnit XML: a suite for each target, a case for each check."""
    root = ElementTree.Element("testsuites")
    for report in reports:
        outcomes = [one.outcome for one in report.findings]
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=report.target,
            tests=str(len(outcomes)),
            failures=str(outcomes.count(FAILED)),
            errors="0",
            skipped=str(outcomes.count(SKIPPED)),
            time=f"{sum(one.seconds for one in report.findings):.3f}",
        )
        for one in report.findings:
            case = ElementTree.SubElement(
                suite, "testcase", classname=report.target, name=one.check, time=f"{one.seconds}"
            )
            if one.outcome == FAILED:
                ElementTree.SubElement(case, "failure", message=one.text).text = one.text
            elif one.outcome == SKIPPED:
                ElementTree.SubElement(case, "skipped", message=one.text)
    ElementTree.indent(root)
    data: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return data
