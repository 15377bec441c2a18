"""Base classes of joints and forces: fields with units, and equations in SymPy, written once.

An element's equations are static functions of `e`, the element with its markers as symbolic frames
(`stiffmbs.compile.symbolic.planar_frames.Frame`, in space `stiffmbs.compile.symbolic.spatial_frames.SpatialFrame`) and
its numbers as symbols. Jacobians, velocity and acceleration terms, reactions and kernels are derived from them.
"""

from __future__ import annotations

import builtins
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from pydantic import GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from ..errors import InputError
from ..reading.fields import Described, typed
from ..reading.formula.formula import Formula
from ..reading.joint_name import joint_channels
from ..reading.marker import MarkerReference

if TYPE_CHECKING:
    from ..model.model_data import ModelData
    from .initial_pose import InitialPose
    from .loads import Loads

Part = TypeVar("Part")
Symbolic = Any
"""Element as its equations see it (`stiffmbs.compile.symbolic.element.SymbolicElement`). Markers are frames, numbers
symbols, and formulas expressions. Formulas and tables of a variable are functions, and referenced joints are symbolic
elements. Also ``e.t`` for time, ``e.rate(expression)`` and ``e.acceleration(expression)`` for total time derivatives, and ``e.frames`` for the bodies."""


Expr = Any
"""SymPy expression (`sympy.Expr`), or a number."""

Matrix = Any
"""SymPy column vector or matrix (`sympy.Matrix`)."""


class _SymPy:
    """SymPy, imported on first use: runs with compiled kernels do not load it."""

    def __getattr__(self, name: str) -> Any:
        import sympy

        return getattr(sympy, name)


sp: Any = _SymPy()
"""Functions of SymPy for equations."""


IN_EQUATIONS = frozenset([
    "a", "acceleration", "angle", "angles", "at_extremum", "at_root", "breakpoints", "by", "by_accelerations", "by_q", "by_u", "channel", "common_normal",
    "composed", "coordinate", "coordinates", "counts", "depends", "derivatives", "distance", "frames", "in_state", "integral", "joint_angles",
    "is_constant", "kind", "lam", "loads", "logarithm", "meanings", "named", "own", "point", "q", "rate", "reaction",
    "read", "relative_rotation", "second_rate", "shortest_rotation", "slope", "state_rates", "states", "t", "type", "u",
    "variable", "velocities", "velocity_level", "_accelerations", "_coordinate", "_free", "_joint", "_logarithms", "_new_rotation", "_note",
    "_rotations", "_state",
])  # fmt: skip
"""Attributes of the symbolic element `e` in addition to the fields (`stiffmbs.compile.symbolic.element`)."""


def _reserved(element: type[Described], base: type[Described]) -> str:
    """Return the reason why a field of an element class is not allowed, or an empty string.

    `element`: a subclass of joints or forces. `base`: the base whose attributes its fields must not hide.
    """
    names = _names_of(base)
    added = {*element.model_fields, *element.__private_attributes__} - {*base.model_fields}
    if not (found := sorted(added & names)):
        return ""
    listed = ", ".join(sorted(name for name in names if not name.startswith("_")))
    return f"found the field '{found[0]}', expected names other than {listed}"


@cache
def _names_of(base: type[Described]) -> frozenset[str]:
    """Return the names that fields of subclasses must not have."""
    return IN_EQUATIONS.union(name for name in dir(base) if not (name.startswith("__") or hasattr(Described, name)))


@dataclass(frozen=True)
class CompiledTerms:
    """Terms of an element whose kernels are loops over arrays, written by hand instead of derived."""

    # row and column of each entry of each term in the element's own block
    patterns: Mapping[str, list[tuple[int, int]]]
    # return the source of a kernel with some terms, given their places in it by name
    source: Callable[[Mapping[str, int]], str]


class Component(Described):
    """Base of structured fields of an element, such as a road, with fields and equations of their own.

    The equations are static functions whose first argument is the component with symbols for its fields.
    """

    def in_equations(self) -> Mapping[str, Any]:
        """Return the values that its equations see: its fields, or values derived from them."""
        return {name: getattr(self, name) for name in type(self).model_fields}

    def notes(self) -> Iterator[str]:
        """Yield notes about the component for the user."""
        yield from ()


class Element(Described):
    """Base of joints and forces; a subclass in `joints`, `forces` or user code defines a new kind.

    Attributes
    ----------
    kind : str
        Name of the kind in scenes, its `type`.
    dimensions : tuple of int
        Models in which it is available: 2 for the plane, 3 for space; () for the dimension of its markers.
    forms : tuple of mappings of str to object
        Fields of the most common variants, where fields without a default are not enough; ``...`` for any valid value.
        These variants are compiled in advance (``stiffmbs cache warm``) and tested.
    reflected : mapping of str to str, optional
        Transformation of fields in the mirror image of a part; fields that are not listed stay. Each marker's axes X
        become S X S (`stiffmbs.model.parts.frame.Frame`). None: the element cannot be mirrored. For a
        number, a law or components along the axes: ``vector``, ``rotations``, ``components`` (of force, then of
        torque), ``matrix``, ``angle`` (about the last axis), ``pitch`` (along z for each turn), ``x``, ``about x``.
        Names of fields that name joints: as the product of their coordinates. For a marker: the axis whose direction
        matters, such as ``z``.
    symmetric_with : mapping of str to str, optional
        Accepted from elements of earlier versions, without effect.
    spin_conditions : mapping of str to str
        Markers whose bodies may spin without changing the equations, by field, with the conditions. ``x``, ``y`` or
        ``z``: the marker's point is on the spin axis, which is parallel to this axis of the marker. ``along x`` and so
        on: the spin axis is parallel to it, at any distance. ``point``: its point is on the spin axis. ``body``: no
        condition. A body with any other marker keeps its spin in its quaternion (`stiffmbs.presolve.spinning_bodies`).
    known_as : tuple of str
        Names of the kind in other programs, for messages that suggest it.
    symbol : str
        Kind whose symbol drawings show; by default its own, or a diamond or a dashed line if there is none.
    same_in_each_pose : bool
        True if each pose in which the equations hold gives the same open values (`at_initial_pose`).
    """

    kind: ClassVar[str] = ""
    known_as: ClassVar[tuple[str, ...]] = ()
    dimensions: ClassVar[tuple[int, ...]] = ()
    forms: ClassVar[tuple[Mapping[str, object], ...]] = ({},)
    reflected: ClassVar[dict[str, str] | None] = None
    symmetric_with: ClassVar[dict[str, str] | None] = None
    spin_conditions: ClassVar[dict[str, str]] = {}
    symbol: ClassVar[str] = ""
    same_in_each_pose: ClassVar[bool] = False

    type: str = ""

    @classmethod
    def __pydantic_init_subclass__(cls, **options: object) -> None:
        """Refuse fields with the name of an attribute of the base class or of the symbolic element."""
        super().__pydantic_init_subclass__(**options)
        base = next(base for base in cls.__mro__ if base.__module__ == __name__)
        if reason := _reserved(cls, base):
            raise InputError(f"{cls.__name__}: {reason}")

    @model_validator(mode="before")
    @classmethod
    def _of_its_kind(cls, found: object) -> object:
        return typed(cls.kind, found)

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, object]:
        schema = handler(core_schema)
        handler.resolve_ref_schema(schema)["properties"]["type"] = {
            "const": cls.kind, "default": cls.kind, "title": "Type", "type": "string",
        }  # fmt: skip
        return schema

    def own_notes(self) -> Iterator[str]:
        """Yield notes about the element for the user."""
        yield from ()

    def parts(self, part: builtins.type[Part]) -> Iterator[tuple[str, Part]]:
        """Yield the fields of a type, such as markers, formulas or joint names, with field names, in order."""
        fields = vars(self)  # getattr asks pydantic for each
        for name in type(self).__pydantic_fields__:
            value = fields[name]
            if isinstance(value, tuple):
                yield from ((name, item) for item in value if isinstance(item, part))
            elif isinstance(value, part):
                yield name, value

    def markers(self) -> Iterator[tuple[str, MarkerReference]]:
        """Yield the element's markers by field name, the first body's first, then the markers in its formulas."""
        yield from self.parts(MarkerReference)
        for name, formula in self.parts(Formula):
            for _, markers in formula.measures():
                yield from ((name, marker) for marker in markers)

    def equation_names(self) -> tuple[str, ...]:
        """Return the names of the element's constraint equations; none for a force."""
        return ()

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """Yield each field whose joint does not fit, with the reason, "found ..., expected ..."."""
        yield from ()

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        """Yield reasons why the element cannot act at the initial pose."""
        yield from ()

    def spins_with(self) -> dict[str, str]:
        """Return its `spin_conditions`; none if the values of its fields do not permit a spin."""
        return self.spin_conditions

    def at_initial_pose(self, model: ModelData) -> Self:
        """Return the element with open values taken from the described poses of the bodies."""
        return self

    def at_current_pose(self, model: ModelData) -> Self:
        """Return the element with open values where it starts to act during a motion, in the poses of a model."""
        return self.at_initial_pose(model)


class Joint(Element):
    """Constraint between bodies.

    Attributes
    ----------
    equations : tuple of str
        Names of the equations that `position`, then `velocity`, return; used in reports.
    coordinates : tuple of str
        Names of its coordinates, for drives and couplers: ``angle``, ``displacement``. The joint has a static function
        of `e` with each of these names.
    further_coordinates : tuple of str
        Names of its other free coordinates, of `stiffmbs.reading.joint_name.FREE_COORDINATES`, which are only reported
        and used in formulas. The joint has a function with each of these names, too.
    channels : tuple of str
        Names of the values that `measured` returns: the free coordinates with their rates and accelerations.
    transmits : tuple of str
        Reaction components in space along the axes of marker j: forces ``fx fy fz``, and torques ``tx ty tz`` at the
        point of marker i; the channels of these names are along the ground axes. Components along other directions,
        such as the torque of a universal joint, are omitted. Redundancy advice proposes such joints in place of joints that transmit more than necessary.
    elastic : str
        Kind of the compliant force that can replace the joint.
    keeps_in_plane : bool
        True if the spatial joint of the same kind keeps one body in the plane of the other (planar joints with two
        markers).
    """

    equations: ClassVar[tuple[str, ...]] = ()
    coordinates: ClassVar[tuple[str, ...]] = ()
    further_coordinates: ClassVar[tuple[str, ...]] = ()
    written_as: ClassVar[dict[str, str]] = {
        "at_start": "a drive of the joint in the section at_start of the scene: {start: {type: drive, joint: NAME, velocity: 1 rad/s}}"
    }
    channels: ClassVar[tuple[str, ...]] = ()
    transmits: ClassVar[tuple[str, ...]] = ()
    elastic: ClassVar[str] = ""
    keeps_in_plane: ClassVar[bool] = False

    @classmethod
    def __pydantic_init_subclass__(cls, **options: object) -> None:
        """Name the channels of a new kind's free coordinates."""
        super().__pydantic_init_subclass__(**options)
        if cls.free_coordinates():
            channels = joint_channels(cls.free_coordinates())
            if not set(own := cls.__dict__.get("channels", ())) <= set(channels):
                raise InputError(
                    f"{cls.__name__}: found channels {', '.join(own)} of a joint with coordinates, expected none: its channels are those of "
                    "the coordinates; a further_coordinate reports a value of its own"
                )
            cls.channels = channels

    @classmethod
    def free_coordinates(cls) -> tuple[str, ...]:
        """Return the names of all coordinates along which the joint allows motion."""
        return (*cls.coordinates, *cls.further_coordinates)

    @classmethod
    def measured(cls, e: Symbolic) -> Sequence[Expr]:
        """Return the reported values, one expression for each name in `channels`."""
        free = [getattr(cls, name)(e) for name in cls.free_coordinates()]
        return [value for x in free for value in (x, e.rate(x), e.acceleration(x))]

    @staticmethod
    def position(e: Symbolic) -> Sequence[Expr]:
        """Return the constraint equations C(q, t) = 0, one expression for each name in `equations`."""
        return ()

    @staticmethod
    def velocity(e: Symbolic) -> Sequence[Expr]:
        """Return the constraint equations linear in u without a position form, such as a prescribed rate."""
        return ()

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        """Return the reference point of the joint's reaction torque."""
        return e.i.point

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        """Return the loads on the joint's surfaces, from its multipliers ``e.lam``; they are required for friction.

        The joint friction is that of a pin with the coordinate ``angle``, of a guide with ``displacement``, and of a
        sleeve with both. A spatial joint without coordinates has the friction of a ball joint.
        """
        raise NotImplementedError

    def equation_names(self) -> tuple[str, ...]:
        return self.equations


class Force(Element):
    """Applied force: efforts on coordinates or on rates, by virtual power.

    The generalised force is the sum of effort times the derivative of its coordinate. For a spring this is the tension
    on its length; for a force at a point, its components on the point's coordinates. A force on the rate of no
    coordinate, such as a torque in space on an angular velocity, defines `powers` in place of `efforts`.

    Attributes
    ----------
    channels : tuple of str
        Names of the values that `measured` returns, reported as channels of the element.
    has_reaction : bool
        Whether force and torque on its first body are reported.
    may_keep_energy : bool
        Whether the force is conservative for some values of its fields; its equations are tested for them.
    turns : bool
        Whether it represents the rotation of a body in space and contains the body's kinematics, p' = Z(p) w.
    beyond : str
        Message if one of its `limits` is exceeded: "found ..., expected ...".
    doubtful : float
        Value of its limits below which the motion is doubtful; -inf if only the limits themselves matter.
    doubt : str
        Description of the doubt, after the element's name.

    A force can have states of its own, with x' = rate and initial value zero: `own_states` returns their names, `rates`
    their rates, and the equations see them as ``e.own``.
    """

    channels: ClassVar[tuple[str, ...]] = ()
    has_reaction: ClassVar[bool] = True
    may_keep_energy: ClassVar[bool] = True
    turns: ClassVar[bool] = False
    beyond: ClassVar[str] = ""
    doubtful: ClassVar[float] = -math.inf
    doubt: ClassVar[str] = ""

    def valid_ranges(self) -> Mapping[str, tuple[float, float]]:
        """Return the valid ranges of the channels of the element."""
        return {}

    def own_states(self) -> tuple[str, ...]:
        """Return the names of its own states; channels prefix them with the element's name."""
        return ()

    @classmethod
    def rates(cls, e: Symbolic) -> Sequence[Expr]:
        """Return the rates of its own states, per second, in their order."""
        return ()

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return pairs of an effort and the coordinate on which it does work."""
        raise NotImplementedError

    @classmethod
    def powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return pairs of an effort and its conjugate rate, which is linear in the velocities."""
        return [(effort, e.rate(coordinate)) for effort, coordinate in cls.efforts(e)]

    @classmethod
    def condensed_powers(cls, e: Symbolic) -> list[tuple[Expr, Expr]]:
        """Return `powers` of a force that may be very stiff, resolved along its own directions of deformation.

        Radau methods iterate on these efforts as unknowns of their own; none by default.
        """
        return []

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        """Return the potential energy, J; zero for a force without one."""
        return 0

    @classmethod
    def measured(cls, e: Symbolic) -> Sequence[Expr]:
        """Return the reported values in addition to the wrench, one expression for each name in `channels`."""
        return ()

    @staticmethod
    def event_functions(e: Symbolic) -> Sequence[Expr]:
        """Return expressions that change sign at the state-dependent breakpoints of the force, such as a gap."""
        return ()

    @classmethod
    def limits(cls, e: Symbolic) -> Sequence[Expr]:
        """Return expressions that are positive within the valid range of the force law; otherwise the run stops."""
        return ()

    @staticmethod
    def point(e: Symbolic) -> Matrix:
        """Return the point on the first body that is the reference of the force's torque."""
        return e.i.point
