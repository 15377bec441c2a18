"""What a joint and a force are: fields with units, and their equations in SymPy, written once.

An element's equations are static functions of `e`, the element with its markers as symbolic frames
(`stiffmbs.compile.symbolic.planar_frames.Frame`, in space `stiffmbs.compile.symbolic.spatial_frames.SpatialFrame`) and its numbers as
symbols.  Jacobians, velocity and acceleration terms, reactions and kernels are all derived from them, so an element is its
fields, its equations and their names.
"""

from __future__ import annotations

import builtins
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import GetJsonSchemaHandler, model_validator

from ..errors import InputError
from .fields import Described, typed
from .formula.formula import Formula
from .loads import Loads
from .marker import MarkerReference

if TYPE_CHECKING:
    from .initial_pose import InitialPose
    from .model_data import ModelData

Symbolic = Any
"""The element as its equations see it (`stiffmbs.compile.symbolic.element.SymbolicElement`): a frame for a marker, a symbol for a number, an expression for a formula, a
function for a formula or table of a variable, a symbolic element for a joint that is referred to; ``e.t`` for time,
``e.rate(expression)`` for a total time derivative, ``e.frames`` for the bodies."""


IN_EQUATIONS = frozenset(
    [
        "a",
        "angle",
        "angles",
        "at_extremum",
        "breakpoints",
        "by",
        "by_accelerations",
        "by_coordinate",
        "by_coordinates",
        "by_velocities",
        "columns_of",
        "common_normal",
        "composed",
        "coordinate",
        "coordinates",
        "depends",
        "derivatives",
        "distance",
        "frames",
        "in_state",
        "integral",
        "is_constant",
        "kind",
        "lam",
        "loads",
        "meanings",
        "n_coordinates",
        "named",
        "own",
        "point",
        "q",
        "rate",
        "reaction",
        "read",
        "relative_rotation",
        "second_rate",
        "shortest_rotation",
        "slope",
        "state_rates",
        "states",
        "t",
        "type",
        "u",
        "variable",
        "velocities",
        "velocity_level",
        "work_by_coordinates",
        "work_by_velocities",
        "_accelerations",
        "_by_coordinate",
        "_by_velocity",
        "_change",
        "_coordinate",
        "_joint",
        "_matrix",
        "_new_rotation",
        "_note",
        "_rotations",
        "_state",
    ]
)
"""Attributes of the symbolic element `e` in addition to the fields (`stiffmbs.compile.symbolic.element`)."""


def _reserved(element: type[Described], base: type[Described]) -> str:
    """Return the reason why a field of an element class is not allowed, or an empty string.

    Parameters
    ----------
    element : type
        A subclass of joints or forces.
    base : type
        The base whose attributes its fields must not hide.
    """
    names = IN_EQUATIONS | {name for name in dir(base) if not hasattr(Described, name)}
    added = {*element.model_fields, *element.__private_attributes__} - {*base.model_fields}
    if not (found := sorted(added & names)):
        return ""
    listed = ", ".join(sorted(name for name in names if not name.startswith("_")))
    return f"found the field '{found[0]}', expected names other than {listed}"


class Component(Described):
    """Base of what an element is made of besides numbers, with fields and equations of its own, such as a road.

    Its equations are static functions whose first argument is the component with symbols for its fields.
    """

    def in_equations(self) -> Mapping[str, Any]:
        """What its equations see: its fields, or what is made of them."""
        return {name: getattr(self, name) for name in type(self).model_fields}

    def notes(self) -> Iterator[str]:
        """What a user should know of it."""
        yield from ()


class Element(Described):
    """Base of joints and forces.  A subclass is all that a new kind takes: in its own file in `joints` or `forces`, or a user's own.

    Attributes
    ----------
    kind : str
        What scenes call it, as its `type`.
    dimensions : tuple of int
        In which models it can stand, 2 for the plane and 3 for space; () for those that its markers are of.
    forms : tuple of mappings of str to Any
        The fields that make the forms in which it is mostly used, where those that have no default are not enough: these are
        compiled ahead (``stiffmbs cache warm``) and tested.
    reflected : mapping of str to str, optional
        How fields change in the mirror image of a part; those that it does not name stay.  Each marker's axes X become
        S X S (`stiffmbs.describe.parts.planar_frame.PlanarFrame`).  None: the element cannot be mirrored.  For a number, a
        law or components along the axes: ``vector``, ``rotations``, ``components`` (of force, then of torque), ``matrix``,
        ``angle`` (about the last axis), ``pitch`` (along z for each turn), ``x``, ``about x``; names of fields that name joints: as
        the product of their coordinates.  For a marker: its axis whose direction matters, such as ``z``.
    symbol : str
        The kind whose symbol drawings show; its own by default, and a diamond or a dashed line where there is none.
    """

    kind: ClassVar[str] = ""
    dimensions: ClassVar[tuple[int, ...]] = ()
    forms: ClassVar[tuple[Mapping[str, Any], ...]] = ({},)
    reflected: ClassVar[dict[str, str] | None] = None
    symbol: ClassVar[str] = ""

    type: str = ""

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """Refuse fields with the name of an attribute of the base class or of the symbolic element."""
        super().__pydantic_init_subclass__(**options)
        base = next(base for base in cls.__mro__ if base.__module__ == __name__)
        if reason := _reserved(cls, base):
            raise InputError(f"{cls.__name__}: {reason}")

    @model_validator(mode="before")
    @classmethod
    def _of_its_kind(cls, found: Any) -> Any:
        """Let the type be the class's kind."""
        return typed(cls.kind, found)

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        schema = handler(core_schema)
        handler.resolve_ref_schema(schema)["properties"]["type"] = {
            "const": cls.kind, "default": cls.kind, "title": "Type", "type": "string",
        }  # fmt: skip
        return schema

    def parts(self, part: builtins.type) -> Iterator[tuple[str, Any]]:
        """The element's markers, formulas, or joint names: every value of a type, by field name, in order."""
        fields = vars(self)  # getattr asks pydantic for each
        for name in type(self).__pydantic_fields__:
            value = fields[name]
            if isinstance(value, tuple):
                yield from ((name, item) for item in value if isinstance(item, part))
            elif isinstance(value, part):
                yield name, value

    def markers(self) -> Iterator[tuple[str, MarkerReference]]:
        """The element's markers by field name, the first body's first; those in its formulas after its own."""
        yield from self.parts(MarkerReference)
        for name, formula in self.parts(Formula):
            for _, markers in formula.measures():
                yield from ((name, marker) for marker in markers)

    def equation_names(self) -> tuple[str, ...]:
        """The names of the element's constraint equations; none for a force."""
        return ()

    def validation_errors(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """A field and what is wrong with the joint that it refers to, "found ..., expected ..."; nothing where all fit."""
        yield from ()

    def invalid_placement(self, pose: InitialPose) -> Iterator[str]:
        """Why the element cannot act at the initial pose."""
        yield from ()

    def in_space(self, angles: Any) -> dict[str, Any]:
        """The element as a scene in space writes it, in the x-y plane; of a class of the plane.

        By default the kind of the same name in space, with fields that mean the same.

        Parameters
        ----------
        angles : Angles
            Of the planar model (`stiffmbs.describe.spatial.embedding.angles`).

        Raises
        ------
        InputError
            When there is none.
        """
        from .spatial.embedding.fields import namesake

        return namesake(self, angles)

    def spins_with(self) -> dict[str, str]:
        """The markers whose bodies may spin without a change of the equations, by field, and what spinning asks of each.

        ``x``, ``y`` or ``z``: the marker's point is on the spin axis, which lies along this axis of the marker.  ``point``: its
        point is on the spin axis.  ``body``: nothing.  A body with a marker that is not among them keeps its spin in its
        quaternion (`stiffmbs.presolve.spinning_bodies`).
        """
        return {}

    def at_initial_pose(self, model: ModelData) -> Self:
        """The element with what it leaves open taken from the bodies' described poses."""
        return self


class Joint(Element):
    """A constraint between bodies.

    Attributes
    ----------
    equations : tuple of str
        The names of the equations that `position`, then `velocity`, return; used in reports.
    coordinates : tuple of str
        The names of its coordinates, for drives and couplers: ``angle``, ``displacement``.  A joint has a static
        function of `e` by the name of each.
    transmits : tuple of str
        In space what it transmits: forces ``fx fy fz`` along the axes of marker j, and torques ``tx ty tz`` about them at the
        point of marker i.  What does not lie along one of them, as the torque of a universal joint, is left out.  A joint that
        states it is advised in place of one that transmits more than is needed.
    elastic : str
        The kind of force that holds the same elastically.
    keeps_in_plane : bool
        Of a planar joint with two markers whether its namesake in space keeps a body in the plane of the other one.
    """

    equations: ClassVar[tuple[str, ...]] = ()
    coordinates: ClassVar[tuple[str, ...]] = ()
    transmits: ClassVar[tuple[str, ...]] = ()
    elastic: ClassVar[str] = ""
    keeps_in_plane: ClassVar[bool] = False

    @staticmethod
    def position(e: Symbolic) -> Any:
        """The constraint equations C(q, t) = 0, one expression for each name in `equations`."""
        return ()

    @staticmethod
    def velocity(e: Symbolic) -> Any:
        """Equations linear in u that have no position form, such as a prescribed rate."""
        return ()

    @staticmethod
    def point(e: Symbolic) -> Any:
        """The joint's point, about which its torque is reported."""
        return e.i.point

    @staticmethod
    def loads(e: Symbolic) -> Loads:
        """What presses its surfaces, from its multipliers ``e.lam``; a joint that states it can have friction.

        With the coordinate ``angle`` it rubs as a pin, with ``displacement`` as a guide, with both as a sleeve, and in space
        without coordinates as a ball.
        """
        raise NotImplementedError

    def equation_names(self) -> tuple[str, ...]:
        return self.equations


class Force(Element):
    """An applied force: efforts on coordinates or on rates, by virtual power.

    The generalised force is the sum of effort times the derivative of its coordinate: a spring is its tension on
    its length, a force at a point is its components on the point's coordinates.  A force that acts on a rate that
    belongs to no coordinate, as a torque in space on an angular velocity, has `powers` in place of `efforts`.

    Attributes
    ----------
    channels : tuple of str
        Names of what `measured` returns, reported as channels of the element.
    may_keep_energy : bool
        Whether there are numbers with which it keeps energy; they are looked for in its equations.
    turns : bool
        Whether it stands for a body's turning in space, and the body's kinematics, p' = Z(p) w, belong to it.
    beyond : str
        What is wrong where one of its `limits` is passed: "found ..., expected ...".
    doubtful : float
        Value of its limits below which the motion is doubtful; none where the limits alone tell.
    doubt : str
        What is doubtful there, after the element's name.

    A force may have states of its own, values with x' = rate, zero at the start: `own_states` names them, `rates` has their rates,
    and its equations see them as ``e.own``.
    """

    channels: ClassVar[tuple[str, ...]] = ()
    may_keep_energy: ClassVar[bool] = True
    turns: ClassVar[bool] = False
    beyond: ClassVar[str] = ""
    doubtful: ClassVar[float] = -math.inf
    doubt: ClassVar[str] = ""

    def valid_ranges(self) -> Mapping[str, tuple[float, float]]:
        """Return the valid ranges of the channels of the element."""
        return {}

    def own_states(self) -> tuple[str, ...]:
        """The names of its own states; channels have them behind the element's name."""
        return ()

    @classmethod
    def rates(cls, e: Symbolic) -> Any:
        """The rates of its own states, per second, in their order."""
        return ()

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        """Pairs of an effort and the coordinate that it does work on."""
        raise NotImplementedError

    @classmethod
    def powers(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """Pairs of an effort and the rate that it has its power with, the rate being linear in velocities."""
        return [(effort, e.rate(coordinate)) for effort, coordinate in cls.efforts(e)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        """Potential energy, J; zero for a force that has none."""
        return 0

    @classmethod
    def measured(cls, e: Symbolic) -> Any:
        """What is reported of the force besides its wrench, one expression for each name in `channels`."""
        return ()

    @staticmethod
    def event_functions(e: Symbolic) -> Any:
        """Expressions that change their sign where the force has a breakpoint in the state, such as a gap."""
        return ()

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        """Expressions above zero for as long as the force's law holds; where one is not, the run stops."""
        return ()

    @staticmethod
    def point(e: Symbolic) -> Any:
        """The point on the first body about which the force's torque is reported."""
        return e.i.point
