"""What `stiffmbs check` says of joints, as marks of a drawing."""

from __future__ import annotations

from ...analyses.check import Report
from ...describe.parts.names import owner_of
from .scene_graph import Mark


def marks_of(report: Report) -> dict[str, Mark]:
    """Joints with redundant equations, and those whose forces are not unique."""
    marks: dict[str, Mark] = {owner_of(channel): "not unique" for channel in report.not_unique}
    return marks | {joint: "redundant" for joint, _ in report.redundant}
