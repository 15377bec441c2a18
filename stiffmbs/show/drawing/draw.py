"""Drawing of a model as a file or a figure (pictures need matplotlib, the extra ``plot``)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...analyses.check import Report, check
from ...analyses.job import data_of, settings_of
from ...analyses.linearised.at_state import at_state
from ...errors import refuse_missing
from ...reading.names import owner_of
from ...results.channels import channels_of
from ...results.files import refuse_path, write_text
from ...results.provenance import Provenance, provenance_of
from ..style import write_sheet
from .as_json import drawing_json, poses_json
from .derive import drawing_of
from .painted import largest_force
from .picture import Shown, picture
from .poses import Poses, described_poses, poses_of
from .scene_graph import Drawing, Mark
from .view import check_view, view_named

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


def state_drawn(
    model: Any, at: float | None = None, described: bool = False, checked: bool = False, **changes: Any
) -> tuple[Drawing, Poses]:
    """Return the drawing of a model, scene or file and its poses at one instant, s; by default the start of the run.

    `described` is for the bodies before assembly: nothing is solved, so there are no forces. `checked` marks joints
    with redundant equations, and joints whose forces are not unique. `changes` are fields of the settings. Errors are
    those of `stiffmbs.modes`.
    """
    marks = marks_of(check(model, **changes)) if checked else {}
    if described:
        data = data_of(model)
        poses = described_poses(data)
        return drawing_of(data, marks, along=poses), poses
    found = at_state(model, None, at, **changes)
    state, time = found.dynamics.state, np.array([found.t])
    rows = found.dynamics.report(time, state.q[None].copy(), state.u[None].copy(), project=False)
    channels = channels_of(found.data, found.dynamics.system, rows)
    poses = poses_of(found.data, time, channels)
    return drawing_of(found.data, marks, along=poses), poses


def marks_of(report: Report) -> dict[str, Mark]:
    """Return joints with redundant equations, and joints whose forces are not unique."""
    marks: dict[str, Mark] = {owner_of(channel): "not unique" for channel in report.not_unique}
    return marks | {joint: "redundant" for joint, _ in report.redundant}


def write_drawing(
    path: Path, drawing: Drawing, poses: Poses, view: str, names: bool, forces: bool | None, origin: Provenance | None = None
) -> None:  # fmt: skip
    """Write a drawing to a file, completely or not at all, with the origin of its results."""
    if path.suffix == ".json":
        about = {"origin": origin.as_texts()} if origin else {}
        text = json.dumps({"drawing": drawing_json(drawing), "poses": poses_json(poses), **about})
        write_text(path, text)
        return
    sheet = picture(drawing, poses, view_named(view, drawing.dimensions, drawing.gravity), Shown(names, forces))
    write_sheet(path, sheet, dpi=130, origin=origin)


def draw(
    model: object, path: str | Path | None = None, at: float | None = None, described: bool = False,
    checked: bool = False, view: str = "", names: bool = True, forces: bool | None = None, **changes: object,
) -> Sheet | None:  # fmt: skip
    """Draw a model at an instant: bodies by their geometry, joints and forces by the symbols of the field.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    path : str or Path, optional
        Output file: .svg, .png, .pdf, or .json for its shapes as numbers.
    at : float, optional
        Time of the run, s; its start by default.
    described : bool
        True for the bodies as described, before assembly; nothing is solved, so there are no forces.
    checked : bool
        True to mark joints with redundant equations, and joints whose forces are not unique, by colors.
    view : str
        ``front``, ``side``, ``top``, ``isometric``, a plane such as ``xz``, or ``AZIMUTH,ELEVATION`` in degrees; by
        default along z in the plane and isometric in space.
    names : bool
        True to write names.
    forces : bool, optional
        True to draw the forces of joints and force elements as arrows, to scale.
    **changes
        Fields of the run's settings to change.

    Returns
    -------
    matplotlib.figure.Figure or None
        Figure of pyplot, which ``pyplot.show()`` displays; None if a path is given.

    Raises
    ------
    InputError, AssemblyError, SolverError
        As for `stiffmbs.modes`, and for a file that cannot be written or a mesh that cannot be read.
    """
    check_view(view)
    if path is None:
        refuse_missing("matplotlib", "'stiffmbs[plot]'", "draw: ")
    else:
        refuse_path("-o", Path(path), "drawing")
    data = data_of(model)  # type: ignore[arg-type]
    drawing, poses = state_drawn(data, at, described, checked, **changes)
    if path is None:
        seen = view_named(view, drawing.dimensions, drawing.gravity)
        return picture(drawing, poses, seen, Shown(names, forces), on_screen=True)
    chosen = settings_of(data, None, changes)
    write_drawing(Path(path), drawing, poses, view, names, forces, provenance_of(data, chosen))
    return None


def summary(drawing: Drawing, poses: Poses) -> dict[str, object]:
    """Return the content of ``stiffmbs draw --json`` in addition to the file."""
    owners = {part.owner for part in drawing.parts} | {link.owner for link in drawing.links}
    return {
        "bodies": len(drawing.bodies), "elements": len(owners - set(drawing.bodies)), "t": float(poses.time[0]),
        "size": drawing.size, "largest_force": largest_force(drawing, poses), "marks": dict(drawing.marks),
    }  # fmt: skip
