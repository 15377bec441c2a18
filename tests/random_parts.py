"""Random elements of any kind and random scenes, for property tests."""

from __future__ import annotations

import typing

import numpy as np

from stiffmbs import Body, Marker, Model
from stiffmbs.describe.element import Element, JointName
from stiffmbs.describe.fields import Measured
from stiffmbs.describe.formula_field import FormulaOf
from stiffmbs.describe.model import FORCES, JOINTS

OF_COORDINATES = "b0.x*b1.y - 0.3*sin(b1.angle + 2*t) + 0.7*b0.angle^2 + b1.x - t^3 + dm(b0, b1)*az(b1)"
OF_VELOCITIES = "0.2*b0.vx*b1.omega + vr(b0, b1) - 0.1*wz(b1, b0)^2"
ALL_KINDS = [*JOINTS.values(), *FORCES.values()]
LEFT_OUT = {
    "point_on_curve": [("radius",), ("y",)],
    "drive": [
        ("coordinate", "velocity"), ("coordinate", "position"), ("joint", "velocity"), ("joint", "position"),
    ],
}  # fmt: skip
"""Fields to leave out, case by case, of kinds that want one of several."""
CASES = [(kind, left_out) for kind in ALL_KINDS for left_out in LEFT_OUT.get(kind.kind, [()])]
REFERENCES = {"joint_2": "second_pin", "rack": "slider"}
"""The joint of `add_joints` for a field that names one; ``pin`` for all others."""


def add_joints(model: Model) -> None:
    """Joints for other elements to refer to, all with b1 as their second body."""
    model.add("pin", JOINTS["revolute"](i=Marker(body="b0", point=(0.3, -0.2), angle=0.4), j="b1"))
    model.add("second_pin", JOINTS["revolute"](i="b2", j=Marker(body="b1", point=(-0.5, 0.1), angle=-0.7)))
    model.add("slider", JOINTS["prismatic"](i=Marker(body="b2", point=(0.1, 0.6)), j=Marker(body="b1", angle=1.1)))


def refers_to_joints(element: Element) -> bool:
    """Whether an element names joints of the model."""
    return any(True for _ in element.parts(JointName))


def random_element(kind: type[Element], rng: np.random.Generator, left_out: tuple[str, ...] = ()) -> Element:
    """An element with random numbers, its markers on b0, b1, ... in order, its joints those of `add_joints`."""
    fields: dict[str, object] = {}
    bodies = iter(("b0", "b1", "b2"))
    for attribute, field in kind.model_fields.items():
        name = field.alias or attribute
        if typing.get_origin(field.annotation) is typing.Literal or name in left_out:
            continue
        if JointName in _types(field.annotation):
            fields[name] = REFERENCES.get(name, "pin")
        elif field.annotation is Marker or Marker in typing.get_args(field.annotation):
            fields[name] = Marker(body=next(bodies), point=tuple(rng.uniform(-1, 1, 2)), angle=rng.uniform(-3, 3))
        elif numbers := [mark for mark in field.metadata if isinstance(mark, Measured)]:
            fields[name] = _number(numbers[0], rng)
        elif marks := [mark for mark in _marks(field) if isinstance(mark, FormulaOf)]:
            fields[name] = _formulas(marks[0], field)
        elif typing.get_origin(field.annotation) is tuple:
            fields[name] = tuple(rng.uniform(0.5, 1.5, len(typing.get_args(field.annotation))))
    return kind(**fields)


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


def _formulas(mark: FormulaOf, field: object) -> object:
    """A formula of all that a field may hold, as often as it wants it."""
    parts = ["1.3"] + ["sin(2*t)"] * mark.time + [f"0.5*cos({v})^3 + sin({v})" for v in mark.variables]
    parts += [OF_COORDINATES] * mark.coordinates + [OF_VELOCITIES] * mark.velocities
    count = len([part for part in typing.get_args(field.annotation) if part is not Ellipsis and part is not type(None)])
    formula = " + ".join(parts)
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


def random_tree(rng: np.random.Generator, count: int, gravity: bool, grounded: bool, springs: int) -> Model:
    """Bodies joined in a tree by random joints, assembled as described, with undamped springs between them."""
    model = Model(gravity=(0.5, -9.81) if gravity else (0, 0))
    poses = [(0.0, 0.0, 0.0)]
    names = ["ground"]
    for k in range(count):
        name = f"b{k}"
        parent = int(rng.integers(0 if grounded else min(1, k), len(names))) if k or grounded else 0
        x, y, angle = poses[parent]
        here, there = rng.uniform(-0.5, 0.5, 2), rng.uniform(-0.5, 0.5, 2)
        turn = rng.uniform(-2, 2)
        kind = ("revolute", "prismatic", "fixed")[int(rng.integers(0, 3))] if (k or grounded) else "free"
        slide = rng.uniform(-0.3, 0.3) if kind == "prismatic" else 0.0
        axis = rng.uniform(-3, 3)
        point = np.array([x, y]) + _rotated(angle, here) + slide * _rotated(angle + axis, np.array([1.0, 0.0]))
        position = point - _rotated(angle + turn, there)
        poses.append((*position, angle + turn))
        model.add(
            name,
            Body(
                mass=rng.uniform(0.5, 2), inertia=rng.uniform(0.1, 1), position=tuple(position), angle=angle + turn,
                velocity=tuple(rng.uniform(-1, 1, 2)), omega=rng.uniform(-1, 1),
            ),
        )  # fmt: skip
        if kind != "free":
            i = Marker(body=name, point=tuple(there), angle=axis - turn)
            j = Marker(body=names[parent], point=tuple(here), angle=axis)
            model.add(f"joint{k}", JOINTS[kind](i=i, j=j))
        names.append(name)
    for k in range(springs):
        a, b = rng.choice(names[0 if grounded else 1 :], 2, replace=False)
        i, j = (Marker(body=str(n), point=tuple(rng.uniform(-0.5, 0.5, 2))) for n in (a, b))
        model.add(f"spring{k}", FORCES["spring_damper"](i=i, j=j, stiffness=rng.uniform(5, 50), free_length=0.1))
    return model


def _rotated(angle: float, vector: np.ndarray) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
