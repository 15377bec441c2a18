"""Random elements of any kind and random scenes, for property tests."""

from __future__ import annotations

import typing

import numpy as np

import stiffmbs
from stiffmbs import Body, InputError, Marker, Model, spatial
from stiffmbs.elements.element import Component, Element
from stiffmbs.elements.samples import Samples, types_in
from stiffmbs.elements.spatial.orientation import about, conjugate, product
from stiffmbs.model import model as plane
from stiffmbs.model import spatial_model as space
from stiffmbs.reading.fields import Measured
from stiffmbs.reading.formula.field import FormulaOf
from stiffmbs.reading.joint_name import JointName
from stiffmbs.reading.marker import MarkerReference
from stiffmbs.reading.python_function import PythonFunction

Form = tuple[frozenset[str], tuple[tuple[str, typing.Any], ...]]
"""The fields that are left out, and those that are given."""
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
JOINTS = ("pin", "second_pin", "slider")
"""Those of `add_joints`."""
SIGNS = ("hand",)
"""Numbers that are 1 or -1."""


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


class RandomSamples(Samples):
    """Elements with random numbers, all of their fields filled, their markers on b0, b1, ... in order."""

    optional = True

    def __init__(self, rng: np.random.Generator, dimensions: int) -> None:
        self.rng, self.dimensions = rng, dimensions
        model = three_bodies(rng) if dimensions == 2 else three_bodies_in_space(rng)
        add_joints(model)
        super().__init__(lambda k: _marker(f"b{k}", rng, dimensions), model.joints)

    def made(
        self, kind: type[Element], form: typing.Mapping[str, object], left_out: frozenset[str] = frozenset()
    ) -> Element:
        """An element with signs besides numbers."""
        signs = {name: self.rng.choice([-1.0, 1.0]) for name in SIGNS if name in kind.model_fields}
        return super().made(kind, {**signs, **form}, left_out)

    def number(self, mark: Measured) -> float:
        """About one, within the bounds of the field."""
        low = max(0.5, mark.above or 0.0, mark.at_least or 0.0)
        high = low + 1.0 if mark.at_most is None else min(low + 1.0, mark.at_most)
        return self.rng.uniform(low, high)

    def formula(self, mark: FormulaOf, kind: type[Element]) -> str:
        """Of all that the field may hold."""
        if kind.kind == "velocity_equation":
            return LINEAR_IN_VELOCITIES[self.dimensions]
        parts = ["1.3"] + ["sin(2*t)"] * mark.time + [f"0.5*cos({v})^3 + sin({v})" for v in mark.variables]
        parts += [OF_COORDINATES[self.dimensions]] * mark.coordinates + [
            OF_VELOCITIES[self.dimensions]
        ] * mark.velocities
        return " + ".join(parts)


def random_element(
    kind: type[Element], rng: np.random.Generator, form: Form = (frozenset(), ()), dimensions: int = 2
) -> Element:
    """An element with random numbers in a form, its joints those of `add_joints`."""
    left_out, given = form
    samples = RandomSamples(np.random.default_rng(3), dimensions)
    samples.rng, samples.marker = rng, lambda k: _marker(f"b{k}", rng, dimensions)
    return samples.made(kind, dict(given), left_out)


def forms_of(kind: type[Element], dimensions: int) -> list[Form]:
    """The forms of a class that cannot be had together: the fields that each leaves out, and its words and functions.

    One form, of all fields, where these go together.
    """
    try:
        random_element(kind, np.random.default_rng(0), dimensions=dimensions)
        return [(frozenset(), ())]
    except InputError:
        names = {name for form in kind.forms for name in form}
        fixed = [tuple((name, value) for name, value in form.items() if _is_fixed(kind, name)) for form in kind.forms]
        return list(
            dict.fromkeys((frozenset(names - {*form}), own) for form, own in zip(kind.forms, fixed, strict=True))
        )


def _is_fixed(kind: type[Element], name: str) -> bool:
    """Whether a field takes words, a Python function, or a component."""
    types = list(types_in(kind.model_fields[name].annotation)) if name in kind.model_fields else []
    components = [part for part in types if isinstance(part, type) and issubclass(part, Component)]
    return bool(components) or PythonFunction in types or typing.Literal in (typing.get_origin(part) for part in types)


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


CASES = [(dimensions, kind, form) for dimensions, kind in ALL_KINDS for form in forms_of(kind, dimensions)]
"""Every kind, in each of its forms that cannot be had together."""
