"""The same joint and force in space."""

from pydantic import Field

from stiffmbs import si
from stiffmbs.spatial import Force, Joint, Marker

from . import plane


class Ring(Joint):
    """A point on a sphere: the point of marker i stays at a distance from that of marker j."""

    kind = "ring"
    equations = plane.Ring.equations
    transmits = ("fx",)

    i: Marker = Field(description="marker of the first body")
    j: Marker = Field(description="the centre")
    radius: si.PositiveLength = Field(description="m")

    position = staticmethod(plane.Ring.position)


class Bumper(Force):
    """A stop between two points in space."""

    kind = "bumper"

    i: Marker = Field(description="marker of the first body")
    j: Marker = Field(description="marker of the second body")
    stiffness: si.Stiffness = Field(description="N/m")
    gap: si.PositiveLength = Field(description="m")
    damping: si.Damping = Field(0.0, description="N s/m")

    efforts = staticmethod(plane.Bumper.efforts)
    potential = staticmethod(plane.Bumper.potential)
