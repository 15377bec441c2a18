"""Robot as a tree of links: the common content of URDF, SDF and MJCF files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from ..elements.spatial.marker import ORIGIN
from ..elements.spatial.orientation import IDENTITY
from ..reading.files.xml_nodes import FileFault
from .contact import Contact

JointKind = Literal["hinge", "slide", "screw", "ball", "free"]


class RobotFault(FileFault):
    """Invalid or unsupported content of a robot file; the message names the link, joint or actuator."""


GRAVITY: Final = (0.0, 0.0, -9.81)
"""Gravity of simulators for a file that states none, m/s^2."""


@dataclass(frozen=True)
class LinkJoint:
    """Joint between a link and its parent."""

    name: str
    kind: JointKind
    # point, axis: in the link's frame, m; the axis has length 1
    point: tuple[float, ...] = ORIGIN
    axis: tuple[float, ...] = (0.0, 0.0, 1.0)
    # stiffness, damping: N m/rad and N m s/rad of a hinge, screw or ball, N/m and N s/m of a slide
    stiffness: float = 0.0
    damping: float = 0.0
    rest: float = 0.0  # coordinate at which its spring is relaxed, rad or m
    friction: float = 0.0  # magnitude of the dry friction, N m or N
    armature: float = 0.0  # inertia of the rotor reflected to the joint, kg m^2 or kg
    limits: tuple[float, float] | None = None  # limits of the coordinate, rad or m
    speed: float | None = None  # largest magnitude of the coordinate's rate, rad/s or m/s
    effort: tuple[float, float] | None = None  # bounds of the force of all actuators on the coordinate, N m or N
    zero: float = 0.0  # coordinate at the pose given by its `Link`, rad or m
    pitch: float = 0.0  # advance of a screw along its axis in one revolution, m; its coordinate is the angle

    @property
    def is_single(self) -> bool:
        """True for a joint with one coordinate."""
        return self.kind in ("hinge", "slide", "screw")

    @property
    def is_limited(self) -> bool:
        """True for a joint with limits of its coordinate or speed."""
        return self.limits is not None or self.speed is not None

    @property
    def is_rotary(self) -> bool:
        """True for a joint whose coordinate is an angle."""
        return self.kind in ("hinge", "screw")


@dataclass(frozen=True)
class Link:
    """Rigid link."""

    name: str
    parent: str | None  # None for the world
    # position, orientation: frame of the link in the parent's with all joints at their zero: m, quaternion with the
    # scalar first
    position: tuple[float, ...] = ORIGIN
    orientation: tuple[float, ...] = IDENTITY
    mass: float = 0.0
    center_of_mass: tuple[float, ...] = ORIGIN  # in its frame, m
    # shape (3, 3): about the centre of mass in the axes of its frame, kg m^2
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    joints: tuple[LinkJoint, ...] = ()  # in order from the parent; empty if the link is fixed
    lifted: float = 0.0  # fraction of its weight that is balanced (MJCF: gravcomp)

    @property
    def is_heavy(self) -> bool:
        """True for a link with mass or inertia."""
        return self.mass > 0 or bool(np.any(self.inertia))


@dataclass(frozen=True)
class Segment:
    """Straight part of a tendon between points of two links (None: the world), each in its link's frame, m.

    `factor`: its share in the tendon's length, below 1 beyond a pulley.
    """

    link: str | None
    point: tuple[float, ...]
    other: str | None
    other_point: tuple[float, ...]
    factor: float


@dataclass(frozen=True)
class Transmission:
    """Length L with an actuator, spring or damper: the sum of gear times joint coordinate and of factor times segment.

    An actuator's force is gain u + bias with gain = g_0 + g_1 L + g_2 L' and bias = b_0 + b_1 L + b_2 L'; a passive
    tendon has no input u, and its spring and damper are the bias.
    """

    name: str
    gears: Mapping[str, float]  # gear by joint
    # gain, bias: three coefficients each; without a gain there is no input
    gain: tuple[float, ...] | None
    bias: tuple[float, ...]
    # control, force: bounds of the input and of the force
    control: tuple[float, float] | None = None
    force: tuple[float, float] | None = None
    lag: float | None = None  # time constant of the first-order filter of the input, s; 0 for an integrator
    tendon: str = ""  # name of the tendon whose actuators have a bounded total
    # bounds of the total force of all actuators on that tendon; beyond them all forces are scaled by one factor
    total: tuple[float, float] | None = None
    segments: tuple[Segment, ...] = ()  # path of a tendon through space


@dataclass(frozen=True)
class Relation:
    """Coupling of joints: joint - zero = sum of c_k (other - its zero)^k; without `other` the joint is held at c_0."""

    name: str
    joint: str
    other: str | None
    coefficients: tuple[float, ...]


@dataclass(frozen=True)
class Connection:
    """Loop closure between two links (None: the world): by a ball joint, or rigidly.

    `point`, `other_point`: each in its link's frame, m. `orientation`: orientation of the other link's frame in the
    first one's if rigid; None for a ball joint.
    """

    name: str
    link: str | None
    other: str | None
    point: tuple[float, ...]
    other_point: tuple[float, ...]
    orientation: tuple[float, ...] | None


@dataclass(frozen=True)
class Closure:
    """Joints between a link of the tree and another one, or the world, which close a loop; as those of a `Link`."""

    link: str
    parent: str | None  # None for the world
    # position, orientation: frame of the link in the parent's with all joints at their zero: m, quaternion
    position: tuple[float, ...]
    orientation: tuple[float, ...]
    joints: tuple[LinkJoint, ...]  # in order from the parent; at least one


@dataclass(frozen=True)
class Robot:
    """Links, each after its parent, with actuators and constraints. `gravity`: m/s^2. `notes`: omitted content."""

    name: str
    links: tuple[Link, ...]
    gravity: tuple[float, ...] = GRAVITY
    transmissions: tuple[Transmission, ...] = ()
    relations: tuple[Relation, ...] = ()
    connections: tuple[Connection, ...] = ()
    closures: tuple[Closure, ...] = ()
    contacts: tuple[Contact, ...] = ()
    notes: tuple[str, ...] = ()

    def joints(self) -> dict[str, LinkJoint]:
        """Return the joints of the tree by name."""
        return {joint.name: joint for link in self.links for joint in link.joints}
