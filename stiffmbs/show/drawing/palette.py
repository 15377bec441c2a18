"""Colors that are distinct for colour-blind readers and in grey (Okabe and Ito, Color Universal Design, 2008)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from .scene_graph import Drawing, Mark, Part, Role

BODIES = ("#56b4e9", "#e6c229", "#2f9e8f", "#d48fb5", "#8fb339", "#c9733a", "#8da0cb", "#b7a57a")
"""Colors of bodies, in turn."""
ROLES: Mapping[Role, str] = {
    "body": "#56b4e9", "ground": "#8a8a8a", "joint": "#f2f2f2", "drive": "#7b3294", "force": "#00633c", "rubber": "#4d4d4d",
    "floor": "#fbfbfa",
}  # fmt: skip
EDGES: Mapping[Role, str] = {
    "body": "#333333", "ground": "#555555", "joint": "#1a1a1a", "drive": "#7b3294", "force": "#00633c", "rubber": "#1a1a1a",
    "floor": "#d4d4d0",
}  # fmt: skip
MARKS: Mapping[Mark, str] = {"redundant": "#d55e00", "not unique": "#e69f00"}
LOAD, LOAD_NOT_UNIQUE = "#b2182b", "#e69f00"
PAPER = "#ffffff"
RAMP = ("#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725")
"""Colors of a scale from its least to its largest value: viridis, from dark to bright."""


def body_colors(bodies: Iterable[str]) -> dict[str, str]:
    """Return a color for each body, in turn."""
    return {body: BODIES[k % len(BODIES)] for k, body in enumerate(bodies)}


def edge_color(drawing: Drawing, owner: str, role: Role) -> str:
    """Return the color of the lines of an element."""
    mark = drawing.marks.get(owner)
    return MARKS[mark] if mark else EDGES[role]


def face_color(drawing: Drawing, part: Part) -> str:
    """Return the color of the faces of a part."""
    mark = drawing.marks.get(part.owner)
    if mark and part.role in ("joint", "drive"):
        return MARKS[mark]
    return part.color or (drawing.bodies.get(part.owner, "") if part.role == "body" else "") or ROLES[part.role]


def on_ramp(part: float) -> str:
    """Return the color at a part of the scale, 0 to 1."""
    return RAMP[min(round(max(part, 0.0) * (len(RAMP) - 1)), len(RAMP) - 1)]


def shaded(color: str, brightness: float) -> str:
    """Return a color darkened by a factor below 1."""
    parts = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return "#" + "".join(f"{max(0, min(255, round(part * brightness))):02x}" for part in parts)
