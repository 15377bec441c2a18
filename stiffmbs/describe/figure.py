"""The plot that a scene asks for."""

from __future__ import annotations

from pydantic import Field

from .fields import Described


class Figure(Described):
    """Which channels to plot against which, as ``stiffmbs run SCENE --figure FILE`` draws it.

    Parameters
    ----------
    title : str
    x : str
        A channel, or ``time``.
    y : tuple of str
        Channels.
    equal : bool
        Whether both axes have one scale, as for paths in the plane.
    """

    title: str = Field("", description="shown above the plot")
    x: str = Field("time", description="a channel, or time")
    y: tuple[str, ...] = Field(min_length=1, description="channels")
    equal: bool = Field(False, description="one scale for both axes, as for paths in the plane")
