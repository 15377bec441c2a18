"""Animations of mechanisms as files: .gif, .mp4, or a page .html."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from ...analyses.job import Runnable, data_of
from ...analyses.run import run
from ...errors import InputError, StiffmbsError, refuse_missing, refuse_text
from ...model.model_data import ModelData
from ...model.read_scene import read_scene
from ...model.scene import Scene
from ...reading.marker import MarkerReference
from ...results.files import refuse_path, write_text, written_whole
from ...results.solution import Solution
from ..origin import page_with_origin
from ..page.data import moving_page, page_data
from .derive import drawing_of
from .film import Playback, need_encoder, pictures, write_gif, write_mp4
from .picture import Shown
from .poses import placed, poses_of
from .scene_graph import Anchor
from .view import check_view, view_named

FILMS: dict[str, Callable[..., None]] = {".gif": write_gif, ".mp4": write_mp4}


def check_animation(path: Path, playback: Playback) -> None:
    """Check that an animation can be written to a file, and that speed and picture rate are positive."""
    refuse_path("-o", path, "animation")
    need_encoder(path)
    for option, value in (("--speed", playback.speed), ("--rate", playback.rate)):
        if value is not None and not (np.isfinite(value) and value > 0):
            raise InputError(f"{option}: found {value:g}, expected a number greater than 0")


def traced(data: ModelData, names: Sequence[str]) -> list[Anchor]:
    """Return the points of named markers, such as ``coupler.tip``, or of bodies."""
    refuse_text("traces", names, "bodies or markers")
    found = []
    for name in names:
        body, _, marker = (name, "", "") if name in data.bodies else name.rpartition(".")
        known = data.bodies[body].markers if body in data.bodies else {}
        if body not in data.bodies or (marker and marker not in known):
            expected = ", ".join(f"{body}.{one}" for one in known) or ", ".join(data.bodies)
            raise InputError(f"--trace: found '{name}', expected a body or a marker of one such as {expected}")
        point, _ = placed(data, MarkerReference(body=body, marker=marker or None))
        found.append(Anchor(body, point if marker else np.zeros(3)))
    return found


def write_animation(
    path: Path, data: ModelData, runs: Mapping[str, Solution], view: str = "", playback: Playback = Playback(),  # noqa: B008
    shown: Shown = Shown(), traces: Sequence[str] = (),  # noqa: B008
) -> None:  # fmt: skip
    """Write an animation of runs of a model, drawn over each other; the file is complete or not written at all.

    The name of the file ends in .gif, .mp4 or .html. The runs have their names in the legend, and the first one is
    drawn in full colors. `view`, `playback` and `shown` are options of a film; a page can be rotated by hand. `traces` are
    markers or bodies whose paths are drawn. InputError if a run belongs to another model, or a marker is unknown.
    """
    if path.suffix == ".html":
        write_text(path, animation_page(data, runs, traces))
        return
    poses = {name: poses_of(data, run.time, run.channels) for name, run in runs.items()}
    drawing = drawing_of(data, along=next(iter(poses.values())))
    anchors = traced(data, traces)
    seen = view_named(view, drawing.dimensions, drawing.gravity)
    frames = pictures(drawing, poses, seen, playback, shown, anchors)
    written_whole(path, lambda part: FILMS[path.suffix](part, frames, playback.rate))


def animation_page(data: ModelData, runs: Mapping[str, Solution], traces: Sequence[str] = ()) -> str:
    """Return the page of an animation; parameters and errors as for `write_animation`."""
    poses = {name: poses_of(data, run.time, run.channels) for name, run in runs.items()}
    drawing, first = drawing_of(data, along=next(iter(poses.values()))), next(iter(runs.values()))
    figure = first.figure.y if first.figure else ()
    page = moving_page(drawing.name, page_data(drawing, poses, first, figure, traced(data, traces)))
    return page_with_origin(page, first.provenance)


@dataclass(frozen=True, repr=False)
class Animation:
    """Page of a mechanism in motion, which notebooks show."""

    page: str

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.page)}" style="width: 100%; height: 40rem; border: 0"></iframe>'


def scene_of(solution: Solution) -> Scene:
    """Return the scene that a solution has kept; raise an InputError if it has none, or its files are not found."""
    kept = solution.provenance
    try:
        if kept is not None:
            changes = [(path, str(value)) for path, value in kept.changes_in_parts.items()]
            return read_scene(kept.scene_text, changes, solution.name)
        raise InputError("found a solution without its scene")
    except StiffmbsError as error:
        raise InputError(f"animate: {error}; give the scene too: stiffmbs.animate(scene, runs=solution)") from None


def animate(
    model: Runnable | Solution, path: str | Path | None = None, runs: Solution | Mapping[str, Solution] | None = None, view: str = "", speed: float | None = None,
    rate: float = 25.0, names: bool = False, forces: bool | None = None, traces: Sequence[str] = (), **changes: Any,
) -> Animation | None:  # fmt: skip
    """Write an animation of a model, as a film or a page, or return the page for a notebook.

    Parameters
    ----------
    model : Model, Scene, Solution, str or Path
        A model, a scene, a scene's file, or a solution, which is shown with the scene that it has kept.
    path : str or Path, optional
        Output file: .gif, .mp4, or .html for a page that needs no network; by default the page is returned.
    runs : Solution or mapping of str to Solution, optional
        Runs of the model, drawn over each other, by name; by default the model is run.
    view : str
        As for `stiffmbs.draw`.
    speed : float, optional
        Seconds of the model per second of a film; by default 1, or less for a film of at least 4 s.
    rate : float
        Pictures per second of a film.
    names : bool
        True if a film shows names.
    forces : bool, optional
        True for arrows of the forces of joints and force elements; by default in the plane alone.
    traces : sequence of str
        Markers, such as ``coupler.tip``, or bodies, whose paths are drawn.
    **changes
        Fields of the run's settings to change.

    Returns
    -------
    Animation or None
        Page that a notebook shows as the value of a cell; None if a path is given.

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`, and for a file that cannot be written.
    """
    playback = Playback(speed, rate)
    if path is None:
        refuse_missing("jinja2", "'stiffmbs[report]'", "animate: ")
    else:
        check_animation(Path(path), playback)
    check_view(view)
    if isinstance(model, Solution):
        runs = model if runs is None else runs
        model = scene_of(model)
    data = data_of(model)
    traced(data, traces)
    if runs is None:
        runs = run(data, **changes)
    found = {"": runs} if isinstance(runs, Solution) else runs
    if path is None:
        return Animation(animation_page(data, found, traces))
    write_animation(Path(path), data, found, view, playback, Shown(names, forces), traces)
    return None
