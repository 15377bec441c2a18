"""Entries of ``use``: placement and parameters of a part."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from ..fields import Described
from ..units import si


class Use(Described):
    """Part placed in a scene or in another part.

    Parameters
    ----------
    part : str
        Name in ``parts``.
    on : str, optional
        Body that it is mounted on, its ``mount``. The default is ground, and within a part that part's mount.
    parameters : mapping
        Values of the part's parameters that differ from its defaults; formulas use the parameters of the enclosing
        scene or part.
    mounts : mapping
        Bodies of further mounts, in place of the defaults.
    """

    part: str = Field(description="which of the parts")
    on: str | None = Field(None, description="the body that it is placed on; ground unless given")
    parameters: dict[str, Any] = Field(default_factory=dict, description="values of the part's parameters")
    mounts: dict[str, str] = Field(
        default_factory=dict, description="further bodies that the part connects to, by what it calls them"
    )


class PlanarUse(Use):
    """Part placed in the plane.

    Parameters
    ----------
    position, angle
        Position (m) and angle (rad) of the part's frame in the axes of its mount, from that body's centre of mass.
    mirror : str, optional
        Coordinate of the part's frame, x or y, that changes its sign.
    """

    position: tuple[si.Length, si.Length] = Field((0.0, 0.0), description="of the part's frame on its mount, m")
    angle: si.Angle = Field(0.0, description="of the part's frame on its mount, rad")
    mirror: Literal["x", "y"] | None = Field(
        None, description="the coordinate of the part's frame that changes its sign"
    )
