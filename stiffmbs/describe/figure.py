"""Plots that a scene requests."""

from __future__ import annotations

from pydantic import Field, model_validator

from .fields import Described


class Figure(Described):
    """Plot of channels, drawn by ``stiffmbs run SCENE --figure FILE``.

    Parameters
    ----------
    title : str
    x : str
        A channel, or ``time``.
    y : tuple of str
        Channels.
    z : str
        A channel: the figure is then a path in space, of one `y` over `x`.
    equal : bool
        Whether all axes have the same scale, as for paths.
    """

    title: str = Field("", description="shown above the plot")
    x: str = Field("time", description="a channel, or time")
    y: tuple[str, ...] = Field(min_length=1, description="channels")
    z: str = Field("", description="a channel: then a path in space over x, one y and z")
    equal: bool = Field(False, description="one scale for all axes, as for paths")

    @model_validator(mode="after")
    def _one_path(self) -> Figure:
        if self.z and (len(self.y) > 1 or self.x == "time"):
            raise ValueError(
                f"z: found '{self.z}' with x: {self.x}, y: {', '.join(self.y)}, expected a channel x and one y"
            )
        return self
