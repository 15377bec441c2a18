"""Kinematics and compliance of an axle as a table and as a figure; loads of a road on bushings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..studies.suspension.kinematics_and_compliance import KinematicsAndCompliance
from ..studies.suspension.road_loads import COMPONENTS, RoadLoads
from .sections import Section, Table
from .style import new_sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet

SHOWN = {
    "bump": ("toe", "camber", "lateral", "longitudinal", "load", "wheel_rate"),
    "roll": ("toe", "camber", "load", "wheel_rate"),
    "steer": ("toe", "camber"),
    "lateral": ("toe", "camber", "lateral"),
    "lateral_parallel": ("toe", "camber", "lateral"),
    "brake": ("toe", "spin", "longitudinal"),
    "traction": ("toe", "spin", "longitudinal"),
    "aligning": ("toe", "camber"),
    "aligning_parallel": ("toe", "camber"),
}
"""Measures whose slopes are shown for each load case."""


@dataclass(frozen=True)
class Panel:
    """Diagram of the page: curves of one load case."""

    title: str
    case: str  # load case
    shown: tuple[str, ...]  # measures, of wheels (``toe``) or of the axle (``axle.track``)
    over: str = ""  # measure along the other axis; empty for the input of the case
    upright: bool = False  # True if `over` is drawn upwards, as wheel travel is


PANELS = (
    Panel("Bump steer", "bump", ("toe",), "travel", True),
    Panel("Bump camber", "bump", ("camber",), "travel", True),
    Panel("Track change", "bump", ("lateral",), "travel", True),
    Panel("Wheelbase change", "bump", ("longitudinal",), "travel", True),
    Panel("Wheel load", "bump", ("load",), "travel", True),
    Panel("Wheel rate", "bump", ("wheel_rate",), "travel", True),
    Panel("Roll centre height", "bump", ("axle.roll_centre_height",), "travel", True),
    Panel("Caster", "bump", ("caster",), "travel", True),
    Panel("Support angles: brake, drive", "bump", ("brake_angle", "drive_angle"), "travel", True),
    Panel("Roll steer", "roll", ("toe",), "axle.roll_angle"),
    Panel("Roll camber", "roll", ("camber",), "axle.roll_angle"),
    Panel("Roll rate", "roll", ("axle.roll_rate",), "axle.roll_angle"),
    Panel("Roll centre", "roll", ("axle.roll_centre_height",), "axle.roll_centre_lateral"),
    Panel("Steering", "steer", ("toe",)),
    Panel("Ackermann", "steer", ("axle.ackermann",), "axle.steer"),
    Panel("Steering axis at the road", "steer", ("scrub_radius", "caster_trail"), "axle.steer"),
    Panel("Camber over steer", "steer", ("camber",), "axle.steer"),
    Panel("Lateral force: steer", "lateral_parallel", ("toe",)),
    Panel("Lateral force: camber", "lateral_parallel", ("camber",)),
    Panel("Lateral force: steer", "lateral", ("toe",)),
    Panel("Braking: steer", "brake", ("toe",)),
    Panel("Braking: recession", "brake", ("longitudinal",)),
    Panel("Traction: steer", "traction", ("toe",)),
    Panel("Aligning torque: steer", "aligning_parallel", ("toe",)),
)
"""Diagrams of the page, of which an axle shows those that apply."""
COLUMNS = 4
STYLES: tuple[Literal["-"], Literal["--"]] = ("-", "--")
"""Line styles of the left and the right side."""
ROUNDING = 1e-9
"""Largest value, in the unit of a measure, that the table shows as zero."""


def kc_text(scene: str, found: KinematicsAndCompliance) -> str:
    """Return all measures at the described heights, and the slopes of the curves there, as one table."""
    lines = [f"{scene}: {found.axle.title} on a rig, {found.message}", *kc_words(found)]
    rows = [("", *_columns(found), "unit"), *measure_rows(found), *slope_rows(found)]
    width = max(len(row[0]) for row in rows)
    lines += [
        "  ".join((f"{row[0]:{width}}", *(f"{cell:>11}" for cell in row[1:-1]), row[-1])).rstrip() for row in rows
    ]
    if len(found.axle.wheels) == 2:
        lines.append(f"left and right differ by at most {found.asymmetry():.1e}, relative to their curves")
    return "\n".join(lines)


def kc_metrics(found: KinematicsAndCompliance) -> list[tuple[str, str, str]]:
    """Return name, value of the left side or of the axle, and unit of all measures and slopes."""
    rows = [*measure_rows(found), *slope_rows(found)]
    return [(name, next((cell for cell in cells if cell), ""), unit) for name, *cells, unit in rows]


def kc_words(found: KinematicsAndCompliance) -> list[str]:
    """Return the numbers of the vehicle that the measures refer to, and which are assumed."""
    vehicle = found.vehicle
    if not vehicle.wheelbase or vehicle.height is None or vehicle.front is None:
        missing = {
            "wheelbase (--wheelbase)": not vehicle.wheelbase,
            "height of the centre of mass (--cg-height)": vehicle.height is None,
            "position as front or rear axle (an axle of that name, or the wheels of the other one)": vehicle.front
            is None,
        }
        names = ", ".join(name for name, lacks in missing.items() if lacks)
        return [f"without anti-dive, anti-lift and anti-squat, as these are unknown: {names}"]
    sentence = f"wheelbase {vehicle.wheelbase:.4g} m, centre of mass at {vehicle.height:.4g} m"
    return [f"{sentence}; assumed: {', '.join(vehicle.assumed)}" if vehicle.assumed else sentence]


def _columns(found: KinematicsAndCompliance) -> tuple[str, ...]:
    sides = tuple(wheel.side for wheel in found.axle.wheels)
    return (*sides, "axle") if len(sides) == 2 else sides


def measure_rows(found: KinematicsAndCompliance) -> list[tuple[str, ...]]:
    """Return rows of name, value of each side and of the axle, and unit, at the described heights."""
    names = dict.fromkeys(name.partition(".")[2] for name in found.measures)
    return [_row(found, name, found.measures, name, found.unit(f"of.{name}") or "1") for name in names]


def slope_rows(found: KinematicsAndCompliance) -> list[tuple[str, ...]]:
    """Return rows of the slopes of the curves of `SHOWN` at the described heights."""
    rows = []
    for case, sweep in found.sweeps.items():
        slopes = {name: sweep.slope(name) for name in sweep.channels}
        for name in SHOWN[case]:
            unit = f"{found.unit(f'of.{name}') or '1'}/{sweep.case.unit}"
            rows.append(_row(found, f"{case}: {name}", slopes, name, unit))
    return rows


def _row(
    found: KinematicsAndCompliance, title: str, values: Mapping[str, float], name: str, unit: str
) -> tuple[str, ...]:
    cells = (values.get(f"{column}.{name}") for column in _columns(found))
    return (title, *("" if cell is None else f"{cell if abs(cell) > ROUNDING else 0:.5g}" for cell in cells), unit)


def kc_csv(found: KinematicsAndCompliance) -> str:
    """Return all curves as CSV, one row for each point of each load case."""
    names = sorted({channel for sweep in found.sweeps.values() for channel in sweep.channels})
    rows = [",".join(["case", "input", *(f"{name} [{found.unit(name)}]" for name in names)])]
    for name, sweep in found.sweeps.items():
        for k, x in enumerate(sweep.abscissa):
            cells = (f"{sweep.channels[each][k]:.12g}" if each in sweep.channels else "" for each in names)
            rows.append(",".join([name, f"{x:.12g}", *cells]))
    return "\n".join(rows) + "\n"


def kc_figure(found: KinematicsAndCompliance) -> Sheet:
    """Draw the page: the panels that apply to the axle, with wheel travel upwards as chassis engineers draw it."""
    from matplotlib.lines import Line2D

    panels = [panel for panel in PANELS if panel.case in found.sweeps and curves_of(found, panel)]
    columns = min(COLUMNS, max(len(panels), 1))
    rows = max(1, -(-len(panels) // columns))
    figure = new_sheet((3.0 * columns, 2.3 * rows))
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for each, panel in zip(axes, panels, strict=False):
        _draw(each, found, panel)
    for each in axes[len(panels) :]:
        each.set_axis_off()
    figure.suptitle(f"{found.name}: {found.axle.title}")
    sides = [wheel.side for wheel in found.axle.wheels]
    if len(sides) == 2:
        handles = [Line2D([], [], color="black", linestyle=style) for style in STYLES]
        figure.legend(handles, sides, loc="outside lower center", ncols=2, frameon=False, fontsize=8)
    return figure


def kc_section(found: KinematicsAndCompliance) -> Section:
    """Return a report section: the table of measures, that of slopes, and the page of diagrams."""
    columns = (*_columns(found), "unit")
    tables = (
        Table(("at the described heights", *columns), tuple(measure_rows(found))),
        Table(("slope there", *columns), tuple(slope_rows(found))),
    )
    sentence = f"Left and right differ by at most {found.asymmetry():.1e}, relative to their curves."
    sentences = (found.message, *kc_words(found), *((sentence,) if len(found.axle.wheels) == 2 else ()))
    return Section(f"Kinematics and compliance: {found.axle.title}", sentences, tables, (kc_figure(found),))


def curves_of(found: KinematicsAndCompliance, panel: Panel) -> list[tuple[str, str, np.ndarray, np.ndarray]]:
    """Return the curves of a panel that have values, as measure, line style, abscissa and values."""
    sweep = found.sweeps[panel.case]
    curves = []
    for name in panel.shown:
        sides = ["axle"] if name.startswith("axle.") else [wheel.side for wheel in found.axle.wheels]
        for side, style in zip(sides, STYLES, strict=False):
            channel = name if side == "axle" else f"{side}.{name}"
            wheel = found.axle.wheels[0].side if side == "axle" else side
            over = panel.over if panel.over.startswith("axle.") else f"{wheel}.{panel.over}"
            x = sweep.channels.get(over) if panel.over else sweep.abscissa
            if channel in sweep.channels and x is not None and np.any(np.isfinite(sweep.channels[channel] + x)):
                curves.append((name, style, x, sweep.channels[channel]))
    return curves


def _draw(axes: Axes, found: KinematicsAndCompliance, panel: Panel) -> None:
    """Draw one panel."""
    sweep = found.sweeps[panel.case]
    for name, style, x, y in curves_of(found, panel):
        label = worded(name) if style == STYLES[0] else None
        colour = f"C{panel.shown.index(name)}"
        axes.plot(*((y, x) if panel.upright else (x, y)), style, color=colour, linewidth=1.2, label=label)
    if len(panel.shown) > 1:
        axes.legend(fontsize=6, frameon=False)
    own = f"{worded(' / '.join(panel.shown))} ({unit_of(found, panel.shown[0]) or '1'})"
    other = f"{sweep.case.swept} ({sweep.case.unit})"
    if panel.over:
        other = f"{worded(panel.over)} ({unit_of(found, panel.over)})"
    along, upwards = (own, other) if panel.upright else (other, own)
    axes.set_xlabel(along, fontsize=7)
    axes.set_ylabel(upwards, fontsize=7)
    axes.set_title(panel.title, fontsize=8)
    axes.tick_params(labelsize=6)
    axes.locator_params(axis="x", nbins=6)
    axes.grid(alpha=0.3)


def unit_of(found: KinematicsAndCompliance, name: str) -> str:
    """Return the unit of a measure of a wheel or of the axle; empty for plain numbers."""
    return found.unit(name if "." in name else f"wheel.{name}")


def worded(name: str) -> str:
    """Return the name of a measure in words."""
    words = name.replace("axle.", "").replace("_", " ")
    return words.replace("fvsa", "front-view swing arm").replace("svsa", "side-view swing arm")


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
    sentence = f"Largest forces and torques of bushings in their own axes (N, N m), over {', '.join(found.loads)}."
    return Section("Road loads", (sentence,), (Table(("bushing", *COMPONENTS), tuple(rows)),))
