"""An entry of ``use``: where a part stands in a scene, and with which parameters."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from ..fields import Described
from ..units import si


class Use(Described):
    """A part placed in a scene, or in another part.

    Parameters
    ----------
    part : str
        Which of ``parts``.
    on : str, optional
        The body that it is placed on, its ``mount``: ground, and within a part that part's own mount, unless given.
    parameters : mapping
        Values of the part's parameters that differ from its own; formulas of the parameters where the entry stands.
    mounts : mapping
        Bodies in place of those that the part connects to besides its mount.
    """

    part: str = Field(description="which of the parts")
    on: str | None = Field(None, description="the body that it is placed on; ground unless given")
    parameters: dict[str, Any] = Field(default_factory=dict, description="values of the part's parameters")
    mounts: dict[str, str] = Field(
        default_factory=dict, description="further bodies that the part connects to, by what it calls them"
    )


class PlanarUse(Use):
    """A part placed in the plane.

    Parameters
    ----------
    position, angle
        Of the part's frame in the axes of the body that it is placed on, from that body's centre of mass, m, rad.
    mirror : str, optional
        The coordinate of the part's frame, x or y, that changes its sign.
    """

    position: tuple[si.Length, si.Length] = Field((0.0, 0.0), description="of the part's frame on its mount, m")
    angle: si.Angle = Field(0.0, description="of the part's frame on its mount, rad")
    mirror: Literal["x", "y"] | None = Field(
        None, description="the coordinate of the part's frame that changes its sign"
    )
