"""Random elements of any kind and random scenes, for property tests."""

from __future__ import annotations

import typing

import numpy as np

import stiffmbs
from stiffmbs import Body, Marker, Model, spatial
from stiffmbs.describe import model as plane
from stiffmbs.describe.element import Element, JointName
from stiffmbs.describe.fields import Measured
from stiffmbs.describe.formula.field import FormulaOf
from stiffmbs.describe.marker import MarkerReference
from stiffmbs.describe.spatial import model as space
from stiffmbs.describe.spatial.orientation import about, conjugate, product

FAMILIES = {2: stiffmbs, 3: spatial}
OF_COORDINATES = {
    2: "b0.x*b1.y - 0.3*sin(b1.angle + 2*t) + 0.7*b0.angle^2 + b1.x - t^3 + dm(b0, b1)*az(b1)",
    3: "b0.x*b1.y - 0.3*sin(b1.z + 2*t) + 0.7*b0.q1*b1.q2 + b1.x - t^3 + dm(b0, b1)*dz(b1, b0, b1)",
}
OF_VELOCITIES = {
    2: "0.2*b0.vx*b1.omega + vr(b0, b1) - 0.1*wz(b1, b0)^2",
    3: "0.2*b0.vx*b1.wy + vr(b0, b1) - 0.1*wz(b1, b0, b0)^2",
}
LINEAR_IN_VELOCITIES = {
    2: "(1 + b0.x)*b0.vx + sin(t + b1.angle)*b1.omega - vr(b0, b1)*b1.y - b0.x*t",
    3: "(1 + b0.x)*b0.vx + sin(t + b1.z)*b1.wy - vx(b0, b1, b0)*b0.q2 - wz(b1, b0)*t",
}
"""For the kinds whose formulas have to be so; by the dimensions of the model, as all of these."""
ALL_KINDS = [
    (dimensions, kind) for dimensions, family in ((2, plane), (3, space))
    for kind in (*family.JOINTS.values(), *family.FORCES.values())
]  # fmt: skip
LEFT_OUT = {
    "point_on_curve": [("radius",), ("y",)],
    "sphere_contact": [("surface_radius",)],
    "drive": [
        (*one_way, level)
        for one_way in (("coordinate", "i", "j"), ("joint",)) for level in ("velocity", "position")
    ],
}  # fmt: skip
"""Fields to leave out, case by case, of kinds that want one of several."""
CASES = [(dimensions, kind, left_out) for dimensions, kind in ALL_KINDS for left_out in LEFT_OUT.get(kind.kind, [()])]
WANTED = {"joint_friction": {"radius": 0.7}}
"""Fields of their own that the joints referred to ask for."""
REFERENCES = {"joint_2": "second_pin", "rack": "slider"}
"""The joint of `add_joints` for a field that names one; ``pin`` for all others."""


def add_joints(model: typing.Any) -> None:
    """Joints for other elements to refer to, all with b1 as their second body."""
    if isinstance(model, Model):
        on_b0, on_b1 = Marker(body="b0", point=(0.3, -0.2), angle=0.4), Marker(body="b1", point=(-0.5, 0.1), angle=-0.7)
        on_b2, along = Marker(body="b2", point=(0.1, 0.6)), Marker(body="b1", angle=1.1)
    else:
        on_b0 = _nearly_along_z(model, "b0", (0.3, -0.2, 0.4), 0.2)
        on_b1 = _nearly_along_z(model, "b1", (-0.5, 0.1, 0.2), -0.3)
        on_b2 = _nearly_along_z(model, "b2", (0.1, 0.6, -0.3), 0.1)
        along = _nearly_along_z(model, "b1", (0.0, 0.2, 0.0), 0.25)
    family = FAMILIES[2 if isinstance(model, Model) else 3]
    model.add("pin", family.Revolute(i=on_b0, j=on_b1))
    model.add("second_pin", family.Revolute(i=on_b2, j=on_b1))
    model.add("slider", family.Prismatic(i=on_b2, j=along))


def _nearly_along_z(model: spatial.Model, body: str, point: tuple[float, ...], tilt: float) -> spatial.Marker:
    """A marker whose axes are nearly those of the ground, as the body is drawn."""
    turned = conjugate(model.bodies[body].orientation)
    tilted = product(about(0, tilt), about(2, 2 * tilt))
    return spatial.Marker(body=body, point=point, orientation=product(turned, tilted))


def refers_to_joints(element: Element) -> bool:
    """Whether an element names joints of the model."""
    return any(True for _ in element.parts(JointName))


def random_element(
    kind: type[Element], rng: np.random.Generator, left_out: tuple[str, ...] = (), dimensions: int = 2
) -> Element:
    """An element with random numbers, its markers on b0, b1, ... in order, its joints those of `add_joints`."""
    fields: dict[str, object] = dict(WANTED.get(kind.kind, {}))
    bodies = iter(("b0", "b1", "b2"))
    for attribute, field in kind.model_fields.items():
        name = field.alias or attribute
        types = _types(field.annotation)
        if typing.Literal in (typing.get_origin(part) for part in types) or name in left_out:
            continue
        if JointName in types:
            fields[name] = REFERENCES.get(name, "pin")
        elif any(isinstance(part, type) and issubclass(part, MarkerReference) for part in types):
            fields[name] = _marker(next(bodies), rng, dimensions)
        elif numbers := [mark for mark in field.metadata if isinstance(mark, Measured)]:
            fields[name] = _number(numbers[0], rng)
        elif marks := [mark for mark in _marks(field) if isinstance(mark, FormulaOf)]:
            fields[name] = _formulas(marks[0], field, dimensions, kind.kind == "velocity_equation")
        elif typing.get_origin(field.annotation) is tuple:
            fields[name] = tuple(rng.uniform(0.5, 1.5, len(typing.get_args(field.annotation))))
    return kind(**fields)


def _marker(body: str, rng: np.random.Generator, dimensions: int) -> MarkerReference:
    """A marker somewhere on a body."""
    point = tuple(rng.uniform(-1, 1, dimensions))
    if dimensions == 2:
        return Marker(body=body, point=point, angle=rng.uniform(-3, 3))
    return spatial.Marker(body=body, point=point, orientation=_turn(rng))


def _turn(rng: np.random.Generator) -> tuple[float, ...]:
    """A random unit quaternion."""
    p = rng.normal(size=4)
    return tuple(p / np.linalg.norm(p))


def _number(mark: Measured, rng: np.random.Generator) -> float:
    """About one, within the bounds of the field."""
    low = max(0.5, mark.above or 0.0, mark.at_least or 0.0)
    high = low + 1.0 if mark.at_most is None else min(low + 1.0, mark.at_most)
    return rng.uniform(low, high)


def _types(annotation: object) -> list[object]:
    """A type and all types that it is made of."""
    return [annotation, *(part for inner in typing.get_args(annotation) for part in _types(inner))]


def _marks(field: object) -> list[object]:
    """The marks of a field, wherever in its type they stand."""

    def inside(annotation: object) -> list[object]:
        marks = list(getattr(annotation, "__metadata__", ()))
        return marks + [mark for part in typing.get_args(annotation) for mark in inside(part)]

    return [*field.metadata, *inside(field.annotation)]


def _formulas(mark: FormulaOf, field: object, dimensions: int, linear: bool) -> object:
    """A formula of all that a field may hold, as often as it wants it."""
    parts = ["1.3"] + ["sin(2*t)"] * mark.time + [f"0.5*cos({v})^3 + sin({v})" for v in mark.variables]
    parts += [OF_COORDINATES[dimensions]] * mark.coordinates + [OF_VELOCITIES[dimensions]] * mark.velocities
    count = len([part for part in typing.get_args(field.annotation) if part is not Ellipsis and part is not type(None)])
    formula = LINEAR_IN_VELOCITIES[dimensions] if linear else " + ".join(parts)
    return (formula,) * count if typing.get_origin(field.annotation) is tuple else formula


def three_bodies(rng: np.random.Generator, gravity: bool = True) -> Model:
    """Bodies b0, b1, b2 of random mass and motion."""
    model = Model(gravity=(0.3, -9.81) if gravity else (0, 0))
    for k in range(3):
        model.add(
            f"b{k}",
            Body(
                mass=rng.uniform(0.5, 2),
                inertia=rng.uniform(0.1, 1),
                position=(2.0 * k + rng.uniform(-0.5, 0.5), rng.uniform(-1, 1)),
                angle=rng.uniform(-3, 3),
                velocity=tuple(rng.uniform(-1, 1, 2)),
                omega=rng.uniform(-1, 1),
            ),
        )
    return model


def three_bodies_in_space(rng: np.random.Generator) -> spatial.Model:
    """As `three_bodies`, in space, with centres of mass and principal axes of their own."""
    model = spatial.Model(gravity=(0.3, -9.81, 0.7))
    for k in range(3):
        axes, moments = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.uniform(0.4, 0.6, 3)
        model.add(
            f"b{k}",
            spatial.Body(
                mass=rng.uniform(0.5, 2),
                inertia=(axes * moments) @ axes.T,
                center_of_mass=tuple(rng.uniform(-0.3, 0.3, 3)),
                position=(2.0 * k + rng.uniform(-0.5, 0.5), *rng.uniform(-1, 1, 2)),
                orientation=_turn(rng),
                velocity=tuple(rng.uniform(-1, 1, 3)),
                omega=tuple(rng.uniform(-1, 1, 3)),
            ),
        )
    return model
