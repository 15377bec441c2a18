"""Content of a planar or spatial model: named bodies, joints and forces, validated as a whole."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Collection, Container, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field, PrivateAttr, ValidationInfo, field_validator, model_validator

from ..elements.body import check_names
from ..elements.element import Element, Force, Joint
from ..elements.initial_pose import InitialPose
from ..elements.requests.check import by_channel, check_output
from ..elements.requests.names import OutputNames
from ..elements.requests.order import dimensions
from ..elements.requests.output import Output
from ..elements.states.amount import InputValue, formulas_of_inputs
from ..elements.states.entry import StateValue
from ..elements.states.section import AnyState, Scope, check_formula, check_states, names_in_formulas, refuse_loops
from ..elements.states.state_name import StateName, own_state
from ..methods import NotebookMethods
from ..reading.did_you_mean import instead_of
from ..reading.fields import Described
from ..reading.formula.formula import Formula
from ..reading.formula.names import NAMES
from ..reading.formula.nodes import TIME
from ..reading.formula.text import UNIT
from ..reading.joint_name import JointName
from ..reading.marker import GROUND, MarkerReference, check_marker
from ..reading.names import beginnings
from .current_pose import CurrentPose

if TYPE_CHECKING:
    from ..elements.states.equation import AngleCounter

STARTS_LATER = "starts_later"
"""Key of a validation's context: names of the joints and forces that start to act in a later pose."""
RESERVED = (GROUND, "energy", "constraint", "time", TIME, UNIT)


class ModelData(NotebookMethods, Described):
    """Content of a model as in a scene, validated as a whole.

    Names are unique across the sections, because channels are named after them.
    """

    origin: ClassVar[Any]
    """Placement of a marker that is a body itself."""
    output_names: ClassVar[OutputNames]
    """Names available in requests."""

    name: str = Field("", description="shown in summaries")
    dimensions: int
    gravity: tuple[float, ...]
    markers: dict[str, Any] = Field(default_factory=dict, description="named points of ground")
    bodies: dict[str, Any] = Field(description="bodies by name")
    states: dict[str, AnyState] = Field(
        default_factory=dict, description="values by name that equations of their own determine"
    )
    inputs: dict[str, InputValue] = Field(
        default_factory=dict, description="values by name that another program provides: numbers, or tables of time"
    )
    joints: dict[str, Any] = Field(default_factory=dict, description="joints by name")
    forces: dict[str, Any] = Field(default_factory=dict, description="forces by name")
    requests: dict[str, Any] = Field(default_factory=dict, description="formulas to report, by channel name")
    _current_pose: CurrentPose | None = PrivateAttr(default=None)
    _turns_of_joints: Mapping[str, int] = PrivateAttr(default_factory=dict)  # in space, that drives select

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {contents(self)}>"

    def __str__(self) -> str:
        return repr(self)

    @field_validator("markers", mode="before")
    @classmethod
    def _named_markers(cls, markers: object) -> object:
        if isinstance(markers, dict):
            check_names(markers, "marker")
        return markers

    @field_validator("bodies", "states", "inputs", "joints", "forces", "requests", mode="before")
    @classmethod
    def _names(cls, named: object, info: object) -> object:
        if isinstance(named, dict):
            check_names(named, "entry")
            for name in named:
                if name in RESERVED:
                    raise ValueError(f"found the name '{name}', which is reserved, expected another")
        return named

    @model_validator(mode="after")
    def _whole(self, info: ValidationInfo) -> ModelData:
        if not self.bodies:
            raise ValueError("bodies: found no body, expected at least one")
        seen: dict[str, str] = {}
        for section in ("bodies", "states", "inputs", "joints", "forces", "requests"):
            for name in getattr(self, section):
                if name in seen:
                    raise ValueError(f"{section}.{name}: found a name that {seen[name]} has too, expected another")
                seen[name] = f"{section}.{name}"
        for name in seen:
            owner = next((o for o, rest in beginnings(name) if rest and (o in seen or o in RESERVED)), None)
            if owner is not None:
                raise ValueError(
                    f"{seen[name]}: found '{owner}' before a dot in '{name}', which is a name, expected another"
                )
        check_states(self.states, self._scope())
        refuse_loops(self.state_outputs())
        placed = {
            f"{section}.{name}": x for section in ("joints", "forces") for name, x in getattr(self, section).items()
        }
        self.check_elements(placed, (info.context or {}).get(STARTS_LATER, ()))
        self.check_requests()
        return self

    def _scope(self) -> Scope:
        return Scope(self.bodies, self.joints, self.markers, NAMES[self.dimensions], self.names_in_formulas())

    def check_elements(self, placed: Mapping[str, Element], later: Container[str] = ()) -> None:
        """Refuse joints and forces with unknown references, or that cannot act at the initial pose.

        `later`: names of those that start to act in another pose, in which they are checked.
        """
        scope = self._scope()
        for where, element in placed.items():
            check_element(where, element, scope)
        pose = InitialPose(self)
        for where, element in placed.items():  # requires valid references in all elements
            for reason in () if where.partition(".")[2] in later else element.invalid_placement(pose):
                raise ValueError(f"{where}: {reason}")

    def check_requests(self) -> None:
        """Refuse requests with unknown or circular references, and units that do not fit."""
        outputs = self.outputs()
        for channel, output in outputs.items():
            check_output(f"requests.{channel}", output, self, self.output_names, outputs)
        dimensions(outputs)

    def outputs(self) -> dict[str, Output]:
        """Return the requests by channel: a name, or ``name.component``."""
        return dict(by_channel(self.requests)) if self.requests else {}

    def continued_tables(self) -> Collection[str]:
        """Return the names of tables that are meant to go on with the slopes of their ends, such as those of a path."""
        return ()

    def angle_counters(self) -> Iterator[tuple[str, AngleCounter]]:
        """Yield counters of full turns of angles in requests, by the angles' text, if positions do not define them."""
        yield from ()

    @abstractmethod
    def inertial(self, bodies: Mapping[str, Any]) -> Iterable[tuple[str, Force]]:
        """Return the forces of the bodies themselves, such as weights, with the bodies' names."""

    @abstractmethod
    def initial_marker(self, marker: MarkerReference) -> Any:
        """Return a marker with numbers, in ground axes, at the initial pose."""

    @abstractmethod
    def carried(self, marker: MarkerReference) -> tuple[str, Any]:
        """Return the body that carries a marker, and the placement from its centre of mass in the solver's axes."""

    def elements(self) -> Iterator[tuple[str, Element]]:
        """Yield every joint, force, counter, state equation and weight with its name (for a weight, its body's)."""
        yield from self.elements_at_initial_pose()
        yield from self.angle_counters()
        yield from self.state_equations()
        yield from self.inertial(self.bodies)

    def state_equations(self) -> Iterator[tuple[str, Element]]:
        """Yield the rates or updates of the states by their names, and the outputs of their equations."""
        if not self.states and not self.inputs:
            return
        from ..elements.states.equation import FormulaOfRate, Reported, SampledUpdate

        for name, state in self.states.items():
            for full, value in state.values(name):
                equation = SampledUpdate if value.period else FormulaOfRate
                yield full, equation.model_construct(state=StateName(full), formula=value.rate)
        for full, formula in self.state_outputs().items():
            yield full, Reported.model_construct(formula=formula)

    def state_outputs(self) -> dict[str, Formula]:
        """Return named formulas for use in other formulas, such as the output of a transfer function, by full name."""
        of_states = {full: formula for name, state in self.states.items() for full, formula in state.outputs(name)}
        return of_states | dict(formulas_of_inputs(self.inputs)) if self.inputs else of_states

    def names_in_formulas(self) -> set[str]:
        """Return the names of states, outputs and inputs available in formulas."""
        return names_in_formulas(self.states) | set(self.inputs)

    def state_values(self) -> dict[str, StateValue]:
        """Return the unknowns in addition to those of the bodies, by full name."""
        of_model = {full: value for name, state in self.states.items() for full, value in state.values(name)}
        of_forces = (own_state(name, own) for name, force in self.forces.items() for own in force.own_states())
        return of_model | dict.fromkeys(of_forces, StateValue(None, 0.0, 1.0))

    def elements_at_initial_pose(self) -> Iterator[tuple[str, Element]]:
        """Yield joints and forces with their names, with undefined fields taken from the described poses."""
        for name, element in (*self.joints.items(), *self.forces.items()):
            yield name, self.set_up(name, element)

    def joint_at_initial_pose(self, name: str, reader: str = "") -> Joint:
        """Return a joint with its undefined fields taken from the described poses, as the element `reader` reads it."""
        pose, joint = self._current_pose, self.joints[name]
        found: Any = self.set_up(name, joint) if pose is None else pose.set_up_for(reader, name, joint, self)
        return found  # type: ignore[no-any-return]

    def set_up(self, name: str, element: Any) -> Any:
        """Return an element with its undefined fields taken from the described poses, or from those of a restart."""
        pose = self._current_pose
        return element.at_initial_pose(self) if pose is None else pose.set_up(name, element, self)

    def known_angle(self, channel: str) -> float | None:
        """Return the angle of a joint with its full turns, rad, if a restart or the joint states it."""
        angles = self.described_angles() if self._current_pose is None else self._current_pose.angles
        return angles.get(channel)

    def described_angles(self) -> Mapping[str, float]:
        """Return angles of joints whose full turns are described, but do not follow from the poses, by channel, rad."""
        return {}

    def known_own_angle(self, joint: Joint) -> float | None:
        """Return the angle with its full turns that a joint itself counts, rad, if a restart knows it."""
        if self._current_pose is None:
            return None
        return next((self.known_angle(name) for name, other in self.joints.items() if other is joint), None)

    def size(self) -> float:
        """Return the diagonal of the bounding box of all bodies and markers as described, m; 1 for a single point."""
        if self._current_pose is not None:
            return self._current_pose.described.size()
        points = [body.coordinates()[: self.dimensions] for body in self.bodies.values()]
        elements = (*self.joints.values(), *self.forces.values())
        markers = dict.fromkeys(marker for element in elements for _, marker in element.markers())
        points += [self.point(marker) for marker in markers]
        widths = (max(p[k] for p in points) - min(p[k] for p in points) for k in range(self.dimensions))
        return math.hypot(*widths) or 1.0

    def spin_axes(self) -> Mapping[str, str]:
        """Return no spin axes: in a described model every quaternion follows its body's angular velocity."""
        return {}

    def point(self, marker: MarkerReference) -> tuple[float, ...]:
        """Return the position of a marker in ground axes at the start, m."""
        return tuple(float(x) for x in self.initial_marker(marker).point)

    def place(self, marker: MarkerReference) -> Any:
        """Return the placement of a marker in the axes of its body."""
        if marker.marker is None:
            return marker.placement() or self.origin
        own = self.markers if marker.body == GROUND else self.bodies[marker.body].markers
        return own[marker.marker]


def contents(model: Any) -> str:
    """Return a summary of the content of a model or scene."""
    parts = []
    for section in ("bodies", "states", "joints", "forces", "requests"):
        count, one = len(getattr(model, section)), "body" if section == "bodies" else section.removesuffix("s")
        parts += [f"{count} {one if count == 1 else section}"] if count or section == "bodies" else []
    return f"'{model.name}': {', '.join(parts)}"


def _check_deformable(where: str, element: str, body: str, bodies: Mapping[str, Any]) -> None:
    """Refuse an element on a frame or modal coordinates of a flexible body, other than its own: a force there would not deform it."""
    name, _, part = body.rpartition(".")
    is_own = element.removeprefix("joints.").removeprefix("forces.").startswith(f"{name}.")
    of_load = element.rpartition(".")[2] in (part, "torque")
    if not is_own or (element.startswith("forces.") and not of_load):
        own = [other for other in bodies if other.startswith(f"{name}.") and bodies[other].rigid]
        listed = ", ".join(own) or "it has none"
        raise ValueError(
            f"{where}: found '{body}', where a force would not deform the flexible body '{name}', expected one of its interfaces ({listed})"
        )


def check_element(where: str, element: Element, scope: Scope) -> None:
    """Refuse an element with an unknown body, marker, joint or coordinate, or between a body and itself."""
    for field, marker in element.markers():
        check_marker(f"{where}.{field}", marker, scope.bodies, scope.on_ground)
        if marker.body != GROUND and not scope.bodies[marker.body].rigid:
            _check_deformable(f"{where}.{field}", where, marker.body, scope.bodies)
    joints = scope.joints
    for field, joint in element.parts(JointName):
        owner = joint.rpartition(".")[0]
        if joint.joint not in joints and owner in joints:
            own = " or ".join(f"{owner}.{name}" for name in joints[owner].coordinates) or owner
            raise ValueError(f"{where}.{field}: found '{joint}' of the type {joints[owner].kind}, expected {own}")
        if joint.joint not in joints:
            raise ValueError(
                f"{where}.{field}: found the unknown joint '{joint.joint}'{instead_of(joint.joint, joints)}"
            )
        if next(joints[joint.joint].parts(JointName), None):
            raise ValueError(
                f"{where}.{field}: found '{joint}', which refers to a joint itself, expected one between markers"
            )
    for field, reason in element.validation_errors(joints):
        raise ValueError(f"{where}.{field}: {reason}")
    for field, formula in element.parts(Formula):
        written = type(element).model_fields[field].alias or field
        check_formula(f"{where}.{written}", formula, scope)
    placed = [marker.body for field, marker in element.parts(MarkerReference) if field in ("i", "j")]
    if len(placed) > 1 and len(set(placed)) == 1:
        raise ValueError(f"{where}: found '{placed[0]}' on both sides, expected two different bodies")
