"""Loads of bushings as text."""

from __future__ import annotations

from ..studies.suspension.road_loads import COMPONENTS, RoadLoads
from .sections import Section, Table


def road_loads_text(scene: str, found: RoadLoads) -> str:
    """Return a line for each component of each bushing: its peak with time and load case."""
    lines = [f"{scene}: largest loads of bushings in their own axes (N, N m) over {', '.join(found.loads)}"]
    for name, peaks in found.peaks.items():
        lines.append(name)
        lines += [f"  {peak.component} {peak.value:>12.5g} at {peak.time:>8.4g} s, {peak.case}" for peak in peaks]
    return "\n".join(lines)


def road_loads_section(found: RoadLoads) -> Section:
    """Return a report section with a line for each bushing, and the time of each peak."""
    rows = [
        (name, *(f"{peak.value:.5g} at {peak.time:.4g} s" for peak in peaks)) for name, peaks in found.peaks.items()
    ]
    told = f"Largest forces and torques of bushings in their own axes (N, N m), over {', '.join(found.loads)}."
    return Section("Road loads", (told,), (Table(("bushing", *COMPONENTS), tuple(rows)),))
