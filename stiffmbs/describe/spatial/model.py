"""The model in space: its kinds of joints and forces, and what it holds by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Literal

import numpy as np
from pydantic import Field

from ..element import Force, Joint
from ..fields import Described
from ..forces.weight import weights
from ..given import Law, Numbers
from ..kinds import Kinds, any_of
from ..marker import GROUND, MarkerReference
from ..model_builder import ModelBuilder
from ..model_data import ModelData
from ..parts.names import Names
from ..request import Request
from ..units import si
from . import forces, joints
from .body import Body, BodyHandle
from .forces.gyroscopic_torque import turnings
from .initial_pose import DrawnMarker
from .marker import Placement
from .orientation import matrix, product, rotated
from .output import COUNTED_ANGLES, Output, check_output
from .output_field import Requested

JOINTS = Kinds(joints, Joint, 3)
FORCES = Kinds(forces, Force, 3)

AnyJoint: Any = any_of(JOINTS)
AnyForce: Any = any_of(FORCES)


class SpatialData(ModelData):
    """What a model in space holds."""

    origin = Placement()

    dimensions: Literal[3] = Field(3, description="of the model: space")
    gravity: tuple[si.Acceleration, si.Acceleration, si.Acceleration] = Field(
        (0.0, 0.0, 0.0), description="along the ground's x, y and z, m/s^2"
    )
    markers: dict[str, Placement] = Field(default_factory=dict, description="named points and orientations of ground")
    bodies: dict[str, Body] = Field(description="bodies by name")
    joints: dict[str, AnyJoint] = Field(default_factory=dict, description="joints by name")  # type: ignore[valid-type]
    forces: dict[str, AnyForce] = Field(default_factory=dict, description="forces by name")  # type: ignore[valid-type]

    requests: dict[str, Requested] = Field(
        default_factory=dict, description="formulas to report, by channel name; or several by name under one"
    )

    def check_requests(self) -> None:
        """Refuse requests that name what the model does not have."""
        for channel, output in self.outputs():
            check_output(f"requests.{channel}", output, self)

    def requested(self) -> Iterator[tuple[str, Request]]:
        """None: what is reported in space is evaluated after the run."""
        yield from ()

    def outputs(self) -> Iterator[tuple[str, Output]]:
        """The requests by channel: a name, or ``name.component``."""
        for name, formula in self.requests.items():
            if isinstance(formula, Output):
                yield name, formula
            else:
                yield from ((f"{name}.{component}", output) for component, output in formula.items())

    def counted_angles(self) -> Iterator[tuple[str, Request]]:
        """The angles az(i, j) in requests: only the integration sees every turn, however far apart output points are."""
        angles = (term for _, output in self.outputs() for term in output.terms if term.function in COUNTED_ANGLES)
        for term in dict.fromkeys(angles):
            yield (
                str(term),
                Request.model_validate({"formula": str(term)}, context={"names": Names(frozenset(self.bodies))}),
            )

    def inertial(self, bodies: Mapping[str, Body]) -> Iterable[tuple[str, Force]]:
        """The bodies' weights and the gyroscopic torques of their turning."""
        yield from weights(bodies, self.gravity)
        yield from turnings(bodies)

    def drawn_marker(self, marker: MarkerReference) -> DrawnMarker:
        """A marker with numbers, in ground axes, as the bodies are drawn."""
        placed = self.place(marker)
        if marker.body == GROUND:
            return DrawnMarker(np.array(placed.point), matrix(placed.orientation))
        body = self.bodies[marker.body]
        point = np.array(body.position) + rotated(body.orientation, placed.point)
        return DrawnMarker(point, matrix(product(body.orientation, placed.orientation)))

    def carried(self, marker: MarkerReference) -> tuple[str, Placement]:
        """The body that carries a marker, and where it sits on it, from the centre of mass in the principal axes."""
        placed = self.place(marker)
        return marker.body, placed if marker.body == GROUND else self.bodies[marker.body].carried(placed)


class Requests(Described):
    """Requests before they stand in a model."""

    requested: dict[str, Requested]


class Model(ModelBuilder[SpatialData, Body, BodyHandle]):
    """A model in space built in Python, piece by piece.

    Examples
    --------
    >>> from stiffmbs.spatial import Body, Marker, Model, Revolute
    >>> model = Model("pendulum", gravity=(0, 0, -9.81))
    >>> bar = model.add("bar", Body(mass=1, inertia=(0.001, 0.03, 0.03), position=(0.3, 0, 0)))
    >>> across = {"z": (0, 1, 0)}
    >>> model.add("hinge", Revolute(i=bar.at(-0.3, 0, 0, across), j=Marker(body="ground", orientation=across)))
    """

    data_type = SpatialData
    body_type = Body
    handle_type = BodyHandle
    kinds = JOINTS, FORCES

    def __init__(self, name: str = "", gravity: Numbers = (0.0, 0.0, 0.0)) -> None:
        super().__init__(name, gravity)

    def request(self, name: str, formula: Law | Mapping[str, Law]) -> None:
        """Report a formula of anything that a run knows as a channel of the given name, or several as ``name.component``.

        Parameters
        ----------
        name : str
            Of the channel.
        formula : str, float or mapping of str to these
            In SI units, such as ``"dm(bar.end, ground)"``; several by the names of their components.

        Raises
        ------
        InputError
            When the name is taken, reserved or no identifier, or a formula cannot be read.
        """
        self._check_name(name)
        self.requests[name] = Requests(
            requested={name: dict(formula) if isinstance(formula, Mapping) else formula}
        ).requested[name]
