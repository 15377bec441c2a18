"""Flexible bodies of scenes: each becomes a floating frame, modal coordinates, and a body for each interface."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, TypeVar

import numpy as np
from pydantic import Field, field_validator

from ..elements.body import LineBody, is_flexible
from ..elements.element import Joint
from ..elements.spatial.body import Body
from ..elements.spatial.flexible.bodies import AXES_HELD, UNUSED_HELD, FloatingFrame, ModalCoordinates
from ..elements.spatial.flexible.interface import FlexibleInterface
from ..elements.spatial.flexible.layout import COUPLINGS, components, numbers_of
from ..elements.spatial.joints.orientation import Orientation as HeldAxes
from ..elements.spatial.joints.point_on_line import PointOnLine
from ..elements.spatial.joints.point_on_plane import PointOnPlane
from ..elements.spatial.marker import ORIGIN, Marker, Point
from ..elements.spatial.orientation import IDENTITY, Orientation, matrix
from ..errors import InputError, prefixed
from ..flexible_bodies import description
from ..flexible_bodies.reduced import reduced_body
from ..flexible_bodies.reduction import ReducedBody
from ..reading.fields import Described, Measured, located
from ..reading.files.files_read import FOLDER, Context
from ..reading.files.yaml_text import Content
from ..reading.handle import Handles
from ..reading.units import si

if TYPE_CHECKING:
    from .model_data import ModelData


FRAME, MODES = "frame", "modes"
DRAWN = ("markers", "geometry")
"""Fields of its bodies in a model that may be changed."""
SHARE = 1e-3
"""Mass of the body of an interface, relative to that of the flexible body, which has less by it."""
SMALL = 1e-3
"""Radius of gyration of the body of an interface, relative to the largest of the flexible body."""
SAME_SHAPES = 0.9
"""Smallest singular value of the change of a basis of modes by a small change of a parameter."""
BY_BODY: Final = 3
"""Modal coordinates of one body."""


class Rayleigh(Described):
    """Damping proportional to mass and stiffness: c = mass m + stiffness k."""

    mass: Annotated[float, Measured("frequency", at_least=0)] = Field(0.0, description="factor of the mass matrix, 1/s")
    stiffness: si.TimeOrZero = Field(0.0, description="factor of the stiffness matrix, s")


class FlexibleHandle(Handles):
    """Interfaces of a flexible body in a model built in Python, by name: ``arm.pin``, ``arm["pin"]``."""

    what = "interface"


class FlexibleBody(description.FlexibleBody, LineBody):
    """Flexible body of a scene or a model. Files of a model are relative to the current folder."""

    type: Literal["flexible"] = "flexible"
    position: Point = Field(ORIGIN, description="of the origin of the mesh at the start, m")
    orientation: Orientation = Field(IDENTITY, description="of the axes of the mesh at the start")
    velocity: si.Velocity3 = Field(
        (0.0, 0.0, 0.0), description="velocity of the centre of mass at the start, in ground axes, m/s"
    )
    omega: si.AngularVelocity3 = Field(
        (0.0, 0.0, 0.0), description="angular velocity at the start, in the axes of the mesh, rad/s"
    )
    damping: si.NumberOrZero | Rayleigh | Annotated[tuple[si.NumberOrZero, ...], Field(min_length=1)] = Field(
        0.0,
        description="damping ratio of all modes, of each mode of the free body (the last one for further modes), or mass and stiffness",
    )
    deformation_scale: si.NumberOrZero = Field(
        1.0, description="factor of the deformation in pictures and films", repr=False
    )
    stress_colors: bool = Field(
        False, description="color by von Mises stress in pictures, films and pages; of meshes only", repr=False
    )

    @field_validator("interfaces")
    @classmethod
    def _other_names(cls, found: dict[str, description.InterfaceOfNodes]) -> dict[str, description.InterfaceOfNodes]:
        """Refuse interfaces with the name of the frame or of modal coordinates, whose bodies they would replace."""
        taken = [name for name in found if name == FRAME or (name.startswith(MODES) and name[len(MODES) :].isdigit())]
        if taken:
            raise ValueError(f"found '{taken[0]}', the name of a part of each flexible body, expected another")
        return found

    def add_to(self, model: Any, name: str) -> FlexibleHandle:
        """Add the frame, modal coordinates and interfaces to a model built in Python, and return handles of the interfaces."""
        bodies, joints = bodies_and_joints(name, self, {}, name)
        for full, part in (*bodies.items(), *joints.items()):
            model.add(full, part)
        return FlexibleHandle(name, {each: model.handle_type(f"{name}.{each}", model) for each in self.interfaces})

    def allows(self, old: object, new: object) -> bool:
        """Return True for a body with other markers or shapes; all other fields follow from the finite elements."""
        if not isinstance(old, Body) or type(old) is not type(new):
            return False
        own = {name: getattr(old, name) for name in DRAWN}
        return bool(old == new.model_copy(update=own))  # type: ignore[attr-defined]


def with_flexible_bodies(raw: Content, context: Context) -> dict[str, object]:
    """Return a scene whose flexible bodies are replaced by their frames, modal coordinates and interfaces.

    Raises InputError.
    """
    if raw.get("dimensions", 2) != 3:
        raise InputError("dimensions: found a flexible body, expected 3: flexible bodies are in space")
    bodies, joints = raw["bodies"], raw.get("joints")
    added_bodies: dict[str, object] = {}
    added_joints: dict[str, object] = dict(joints) if isinstance(joints, dict) else {}
    for name, entry in bodies.items():
        if not is_flexible(entry):
            added_bodies[name] = entry
            continue
        own_bodies, own_joints = bodies_and_joints(name, described(entry, f"bodies.{name}", context), context)
        taken = [f"bodies.{part}" for part in own_bodies if part in bodies]
        taken += [f"joints.{part}" for part in own_joints if part in added_joints]
        if taken:
            raise InputError(f"{taken[0]}: found the name of a part of the flexible body {name}, expected another")
        added_bodies |= own_bodies
        added_joints |= own_joints
    return {**raw, "bodies": added_bodies, "joints": added_joints}


def described(entry: object, where: str, context: Context) -> FlexibleBody:
    """Return the description of a flexible body; `where` is its path in the scene. Raises InputError."""
    with located(where):
        return FlexibleBody.model_validate(entry, context=dict(context))


def bodies_and_joints(
    name: str, body: FlexibleBody, context: Context, where: str = ""
) -> tuple[dict[str, Body], dict[str, Joint]]:
    """Return the bodies and joints of a flexible body by their names; its path is ``bodies.NAME`` unless given. Raises InputError."""
    folder = Path(context.get(FOLDER) or "")
    with prefixed(f"{where or f'bodies.{name}'}: "):
        parts = _Parts(name, body, reduced_body(body, folder), folder)
    return dict(parts.bodies()), dict(parts.joints())


def placed(body: FlexibleBody, frame: Any) -> FlexibleBody:
    """Return a flexible body of a part in ground axes. `frame`: a SpatialFrame; of a mirrored part, the mesh is mirrored too."""
    axes = "".join(axis for axis, sign in zip("xyz", frame.signs * body.signs, strict=True) if sign < 0.0)
    return body.model_copy(update={
        "position": frame.to_outside(body.position), "orientation": frame.oriented(body.orientation),
        "velocity": frame.turned(body.velocity), "omega": frame.turned_rate(body.omega), "mirror": axes or None,
    })  # fmt: skip


def described_bodies(bodies: Mapping[str, object]) -> dict[str, FlexibleBody]:
    """Return the descriptions of the flexible bodies of a scene by their names."""
    frames = ((name, body) for name, body in bodies.items() if isinstance(body, FloatingFrame))
    return {name.removesuffix(f".{FRAME}"): frame.source[0] for name, frame in frames}


AnyScene = TypeVar("AnyScene", bound="ModelData")


def with_same_modes(scenes: Sequence[AnyScene], reference: ModelData) -> list[AnyScene]:
    """Return scenes in which each flexible body that differs in one of them has the modes nearest to those of the reference.

    Modes are determined up to their signs, and those of equal frequencies up to a rotation. Numbers of both scenes can
    be compared only if they belong to the same modes. Raises InputError if the modes differ too much.
    """
    known = described_bodies(reference.bodies)
    others = [(scene, described_bodies(scene.bodies)) for scene in scenes]
    differing = [name for name, body in known.items() if any(bodies[name] != body for _, bodies in others)]
    found = []
    for scene in scenes:
        bodies, joints = dict(scene.bodies), dict(scene.joints)
        for name in differing:
            if _is_loaded(scene, name) and not _have_same_modes(known[name], described_bodies(scene.bodies)[name]):
                raise InputError(
                    f"bodies.{name}: found a surface load on modes that change with the value, expected a value on which they do not "
                    "depend, or differences of runs in place of a sensitivity"
                )
            parts = _parts_with_modes(name, scene.bodies[f"{name}.{FRAME}"], reference.bodies[f"{name}.{FRAME}"])
            bodies |= dict(parts.bodies())
            joints |= dict(parts.joints())
        found.append(scene.model_copy(update={"bodies": bodies, "joints": joints}) if differing else scene)
    return found


def _is_loaded(scene: ModelData, name: str) -> bool:
    """Return True if forces act on the modal coordinates of a flexible body."""
    modes = scene.bodies[f"{name}.{FRAME}"].modes
    return any(marker.body in modes for force in scene.forces.values() for _, marker in force.markers())


def _have_same_modes(one: FlexibleBody, other: FlexibleBody) -> bool:
    """Return True if the reductions of two bodies have the same shapes: all but Young's modulus, density and damping are equal."""
    reduced = set(description.FlexibleBody.model_fields)
    first, second = (each.scaled().model_dump(include=reduced) for each in (one, other))
    return first == second


def _parts_with_modes(name: str, frame: FloatingFrame, like: FloatingFrame) -> _Parts:
    """Return the parts of a flexible body with the modes and axes of another one."""
    found, wanted = reduced_body(*frame.source), reduced_body(*like.source)
    turn = _nearest(found.modes, wanted.modes, name)
    found = found.in_basis(turn)
    terms = found.second_order
    shapes = _nearest(terms.static, wanted.second_order.static, name)
    stretch = np.einsum("ikl,ij->jkl", terms.stretch, shapes)
    found = replace(found, second_order=replace(terms, static=terms.static @ shapes, stretch=stretch))
    return _Parts(name, frame.source[0], found, frame.source[1], like.inertia, turn)


def _nearest(shapes: np.ndarray, wanted: np.ndarray, name: str) -> np.ndarray:
    """Return the orthogonal combination of columns that is nearest to other columns, by the polar decomposition."""
    if shapes.shape == wanted.shape:
        combined = np.linalg.lstsq(shapes, wanted)[0]
        left, sizes, right = np.linalg.svd(combined)
        if sizes.min(initial=1.0) > SAME_SHAPES:
            return left @ right  # type: ignore[no-any-return]
    raise InputError(
        f"bodies.{name}: found other modes for a slightly different value, expected similar ones; choose another number of modes"
    )


class _Parts:
    """Bodies and joints that represent one flexible body.

    The body of an interface has a small mass, which is taken from the flexible body at the same point: the sum is that
    of the finite element model. `axes`: inertia tensor of the rigid body of the frame, whose principal axes are those of
    the coordinates. `turn`: modes by columns, as combinations of those of the frequencies.
    """

    def __init__(
        self, name: str, body: FlexibleBody, reduced: ReducedBody, folder: Path, axes: object = None,
        turn: np.ndarray | None = None,
    ) -> None:  # fmt: skip
        self._inertia = reduced.inertia.tolist() if axes is None else axes
        self._basis, self._turned = np.eye(len(reduced.frequencies)) if turn is None else turn, turn is not None
        self._name, self._body, self._reduced, self._folder = name, body, reduced, folder
        self._share = SHARE * reduced.mass
        self._moment = self._share * SMALL**2 * float(np.linalg.eigvalsh(reduced.inertia)[-1]) / reduced.mass
        self._count = -(-len(reduced.frequencies) // BY_BODY)
        self._turn = np.array(matrix(body.orientation))

    def _of_modes(self) -> list[str]:
        return [f"{self._name}.{MODES}{k + 1}" for k in range(self._count)]

    def bodies(self) -> Iterator[tuple[str, Body]]:
        """Yield the frame, the bodies with modal coordinates, and those of the interfaces."""
        body, reduced = self._body, self._reduced
        frame = Body(
            mass=reduced.mass - len(reduced.points) * self._share, inertia=self._inertia, center_of_mass=tuple(reduced.centre),
            position=body.position, orientation=body.orientation, velocity=body.velocity, omega=body.omega, any_moments=True,
        )  # fmt: skip
        fields: dict[str, object] = {name: getattr(frame, name) for name in Body.model_fields}
        fields |= {"numbers": _Numbers(self._numbers(frame)), "modes": tuple(self._of_modes())}
        yield f"{self._name}.{FRAME}", FloatingFrame(**fields, source=(self._body, self._folder), notes=reduced.notes)
        for name in self._of_modes():
            yield name, ModalCoordinates(mass=reduced.mass, inertia=(reduced.mass,) * 3)
        for name, point in zip(body.interfaces, reduced.points, strict=True):
            arm = np.cross(body.omega, point - reduced.centre)
            yield f"{self._name}.{name}", Body(
                mass=self._share, inertia=(self._moment,) * 3, position=tuple(np.array(body.position) + self._turn @ point),
                orientation=body.orientation, velocity=tuple(np.array(body.velocity) + self._turn @ arm), omega=body.omega,
            )  # fmt: skip

    def joints(self) -> Iterator[tuple[str, Joint]]:
        """Yield the joints of the interfaces, and those that hold the axes and the unused ones of modal coordinates."""
        modes = tuple(Marker(body=name) for name in self._of_modes())
        for name in self._of_modes():
            yield AXES_HELD.format(name), HeldAxes(i=Marker(body=name), j=Marker(body="ground"))
        used = len(self._reduced.frequencies) % BY_BODY
        if used:
            held = PointOnLine if used == 1 else PointOnPlane
            along = {"z": (1.0, 0.0, 0.0)} if used == 1 else {"z": (0.0, 0.0, 1.0)}
            name = self._of_modes()[-1]
            yield UNUSED_HELD.format(name), held(i=Marker(body=name), j=Marker(body="ground", orientation=along))  # type: ignore[arg-type]
        for k, name in enumerate(self._body.interfaces):
            shapes = self._by_coordinates(self._reduced.markers[k].T)
            yield f"{self._name}.{name}_interface", FlexibleInterface(
                i=Marker(body=f"{self._name}.{FRAME}", point=tuple(self._reduced.points[k])),
                j=Marker(body=f"{self._name}.{name}"), modes=modes,
                displacements=tuple(shapes[:, :3].ravel()), rotations=tuple(shapes[:, 3:].ravel()),
            )  # fmt: skip

    def _by_coordinates(self, modes: np.ndarray) -> np.ndarray:
        """Return values by mode as values by modal coordinate in m, zero for the unused ones of the last body."""
        found = np.zeros((BY_BODY * self._count, *modes.shape[1:]))
        found[: len(modes)] = np.sqrt(self._reduced.mass) * modes
        return found

    def _numbers(self, frame: Body) -> np.ndarray:
        """Return the numbers of `stiffmbs.compile.machine.flexible.sums`."""
        reduced, n = self._reduced, BY_BODY * self._count
        to_axes = np.array(matrix(frame.principal_axes())).T
        offset = np.zeros(3)
        square = np.trace(reduced.inertia) / 2 * np.eye(3) - reduced.inertia
        first, second = self._by_coordinates(reduced.first), self._by_coordinates(reduced.second)
        own, mass, terms = len(reduced.pairs), reduced.mass, reduced.second_order
        pairs, second_moments, second_first = np.zeros((n, n, 3, 3)), np.zeros((n, n, 3, 3)), np.zeros((n, n, 3))
        pairs[:own, :own] = mass * reduced.pairs
        stiffened = self._body.is_stiffened
        if stiffened:
            second_moments[:own, :own], second_first[:own, :own] = mass * terms.moments, mass * terms.first
        static, Gamma = np.zeros((len(terms.stretch), n)), np.zeros((len(terms.stretch), n, n))
        static[:, :own], Gamma[:, :own, :own] = terms.static.T, np.sqrt(mass) * terms.stretch
        for point, marker in zip(reduced.points - reduced.centre, reduced.markers, strict=True):
            shape = self._by_coordinates(marker.T)[:, :3]
            offset -= self._share * point
            square -= self._share * np.outer(point, point) + self._moment / 2 * np.eye(3)
            first -= self._share * shape
            second -= self._share * np.einsum("a,kb->kab", point, shape)
            pairs -= self._share * np.einsum("la,kb->lkab", shape, shape)
        for k in range(own, n):  # unused coordinates: unit modal mass
            pairs[k, k] += np.eye(3) * reduced.mass / 3
        coupling = np.zeros((COUPLINGS, n, n))
        of_modes = self._stiffness_and_damping(n)
        for between, values in zip(coupling, of_modes, strict=True):
            between[:own, :own] = self._basis.T @ (values[:own, None] * self._basis)
            values[:own] = between[:own, :own].diagonal()
            np.fill_diagonal(between, 0.0)
        square, second, pairs, second_moments = (
            np.einsum("ia,jb,...ab->...ij", to_axes, to_axes, each) for each in (square, second, pairs, second_moments)
        )
        modal_mass = np.trace(pairs, axis1=2, axis2=3) - mass * np.eye(n)
        (X, _), of_Y, of_pairs = components(square), components(second), components(pairs + second_moments)
        found: dict[str, object] = {
            "d0": to_axes @ offset, "X": X, "moments": frame.principal_moments(), "modal_mass": mass,
            "stretch": len(static) if stiffened else 0, "known": len(static), "gravity": 0.0,
            "stiffened": int(stiffened) if self._body.mesh else -1, "coupled": n if self._turned else 0,
            "Y_symmetric": of_Y[0], "Y_axial": of_Y[1], "S": first @ to_axes.T, "stiffness": of_modes[0][:, None], "damping": of_modes[1][:, None],
            "symmetric": of_pairs[0], "axial": of_pairs[1], "T": second_first @ to_axes.T, "of_Z": components(pairs)[1],
            "mass": modal_mass, "coupling": coupling, "static": static, "Gamma": Gamma,
        }  # fmt: skip
        return numbers_of(found, n)

    def _stiffness_and_damping(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        rates = np.full(n, 2 * np.pi * self._reduced.frequencies.max(initial=1.0))
        rates[: len(self._reduced.frequencies)] = 2 * np.pi * self._reduced.frequencies
        mass, given = self._reduced.mass, self._body.damping
        if isinstance(given, Rayleigh):
            return mass * rates**2, mass * (given.mass + given.stiffness * rates**2)
        of_modes = given if isinstance(given, tuple) else (given,)
        ratios = np.full(n, of_modes[-1])
        ratios[: len(of_modes)] = of_modes[:n]
        return mass * rates**2, 2 * ratios * mass * rates


class _Numbers:
    """Array that pydantic does not convert to a list."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Numbers) and np.array_equal(self.array, other.array)

    __hash__ = None  # type: ignore[assignment]
