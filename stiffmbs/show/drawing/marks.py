"""Marks of a drawing from the findings of `stiffmbs check` on joints."""

from __future__ import annotations

from ...analyses.check import Report
from ...describe.parts.names import owner_of
from .scene_graph import Mark


def marks_of(report: Report) -> dict[str, Mark]:
    """Return joints with redundant equations, and joints whose forces are not unique."""
    marks: dict[str, Mark] = {owner_of(channel): "not unique" for channel in report.not_unique}
    return marks | {joint: "redundant" for joint, _ in report.redundant}
