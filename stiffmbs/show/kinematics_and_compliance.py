"""Kinematics and compliance of an axle as a table and as a figure."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..results.files import written_whole
from ..studies.suspension.characteristics import UNITS
from ..studies.suspension.kinematics_and_compliance import KinematicsAndCompliance, Sweep
from .sections import Section, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

SHOWN = {
    "bump": ("toe", "camber", "lateral", "longitudinal", "load"),
    "roll": ("toe", "camber", "load"),
    "steer": ("toe", "camber"),
    "lateral": ("toe", "camber", "lateral"),
    "lateral_parallel": ("toe", "camber", "lateral"),
    "brake": ("toe", "camber", "longitudinal"),
    "traction": ("toe", "camber", "longitudinal"),
    "aligning": ("toe", "camber"),
    "aligning_parallel": ("toe", "camber"),
}
"""Characteristics drawn for each load case."""


def kc_text(scene: str, found: KinematicsAndCompliance) -> str:
    """Return the slopes of all curves at the middle, and the values at both ends, as text."""
    lines = [f"{scene}: {found.axle.left} and {found.axle.right} on a rig, {found.message}"]
    for sweep in found.sweeps.values():
        x = sweep.abscissa
        lines.append(f"{sweep.case.name}: {sweep.case.swept}, {x[0]:g} .. {x[-1]:g} {sweep.case.unit}")
        for channel, values in sweep.channels.items():
            unit = unit_of(channel)
            slope = f"{sweep.slope(channel):>12.5g} {unit or '1'}/{sweep.case.unit}"
            lines.append(f"  {channel:32} {values[0]:>11.5g} .. {values[-1]:<11.5g} {unit:5} {slope}")
    lines.append(f"left and right differ by at most {found.asymmetry():.1e}, relative to their curves")
    return "\n".join(lines)


def unit_of(channel: str) -> str:
    """Return the unit of a characteristic."""
    return UNITS[channel.split(".")[1]]


def kc_csv(found: KinematicsAndCompliance) -> str:
    """Return all curves as CSV, one row for each point of each load case."""
    names = sorted({channel for sweep in found.sweeps.values() for channel in sweep.channels})
    rows = [",".join(["case", "input", *(f"{name} [{unit_of(name)}]" for name in names)])]
    for name, sweep in found.sweeps.items():
        for k, x in enumerate(sweep.abscissa):
            cells = (f"{sweep.channels[each][k]:.12g}" if each in sweep.channels else "" for each in names)
            rows.append(",".join([name, f"{x:.12g}", *cells]))
    return "\n".join(rows) + "\n"


def kc_figure(found: KinematicsAndCompliance) -> Sheet:
    """Draw a row of curves for each load case, left and right."""
    from matplotlib.figure import Figure

    columns = max(len(SHOWN[name]) for name in found.sweeps)
    figure = Figure(figsize=(2.6 * columns, 2.0 * len(found.sweeps)), layout="constrained")
    axes = np.atleast_2d(figure.subplots(len(found.sweeps), columns, squeeze=False))
    for row, sweep in zip(axes, found.sweeps.values(), strict=True):
        _draw_row(row, sweep)
    figure.suptitle(f"{found.name}: {found.axle.left} (solid), {found.axle.right} (dashed)")
    return figure


def draw_kc(path: Path | str, found: KinematicsAndCompliance) -> None:
    """Write the figure to a file.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    sheet = kc_figure(found)
    written_whole(Path(path), lambda part: sheet.savefig(part))


def kc_section(found: KinematicsAndCompliance) -> Section:
    """Return a report section: slopes at the middle and values at both ends of all curves, and the figure."""
    tables = []
    for sweep in found.sweeps.values():
        x, case = sweep.abscissa, sweep.case
        heads = (f"{case.name}: {case.swept}", *(f"at {each:g} {case.unit}" for each in (x[0], x[-1])), "slope", "unit")
        rows = [
            (channel, f"{values[0]:.5g}", f"{values[-1]:.5g}", f"{sweep.slope(channel):.5g}", f"{unit_of(channel) or '1'}/{case.unit}")
            for channel, values in sweep.channels.items()
        ]  # fmt: skip
        tables.append(Table(heads, tuple(rows)))
    title = f"Kinematics and compliance: {found.axle.left} and {found.axle.right}"
    told = f"Left and right differ by at most {found.asymmetry():.1e}, relative to their curves."
    return Section(title, (found.message, told), tuple(tables), (kc_figure(found),))


def _draw_row(row: np.ndarray, sweep: Sweep) -> None:
    shown = SHOWN[sweep.case.name]
    for axes, name in zip(row, shown, strict=False):
        axes.plot(sweep.abscissa, sweep.channels[f"left.{name}"], "-")
        axes.plot(sweep.abscissa, sweep.channels[f"right.{name}"], "--")
        axes.set_xlabel(f"{sweep.case.name} ({sweep.case.unit})", fontsize=8)
        axes.set_ylabel(f"{name} ({UNITS[name]})", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.grid(alpha=0.3)
    for axes in row[len(shown) :]:
        axes.set_axis_off()
