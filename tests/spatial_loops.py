"""Mechanisms in space with loops, for tests of redundancy, presolve and kinematics."""

import math

import numpy as np

from stiffmbs.elements.spatial.orientation import matrix, product, rotated
from stiffmbs.spatial import Body, Marker, Model, Prismatic, Revolute, Spherical, Universal

CRANK, SPAN = 0.5, 2.0


def ground(x=0.0, y=0.0, z=0.0, orientation=(1.0, 0.0, 0.0, 0.0)):
    return Marker(body="ground", point=(x, y, z), orientation=orientation)


def random_turn(rng):
    p = rng.normal(size=4)
    return tuple(p / np.linalg.norm(p))


def turned(model, turn):
    """A model with all bodies and markers of the ground turned about the origin."""
    other = Model(model.name, gravity=tuple(rotated(turn, model.gravity)))
    for name, body in model.bodies.items():
        place = {"position": tuple(rotated(turn, body.position)), "orientation": product(turn, body.orientation)}
        other.add(name, body.model_copy(update=place))
    for name, joint in model.joints.items():
        j = getattr(joint, "j", None)
        if j is not None and j.body == "ground":
            j = ground(*rotated(turn, j.point), orientation=product(turn, j.orientation))
            joint = joint.model_copy(update={"j": j})
        other.add(name, joint)
    return other


def door(tilt=0.0, offset=0.0, kinds=(Revolute, Revolute)):
    """A door on two hinges of one upright axis, the upper one tilted or off to the side."""
    model = Model("door", gravity=(0, 0, -9.81))
    door = model.add("door", Body(mass=20, inertia=(3, 4, 1.2), position=(0.4, 0, 1)))
    axis = {"z": (math.sin(tilt), 0, math.cos(tilt)), "x": (1, 0, 0)}
    lower, upper = kinds
    model.add("lower", lower(i=door.at(-0.4, 0, -0.8), j=ground(0, 0, 0.2)))
    model.add("upper", upper(i=door.at(-0.4, 0, 0.8), j=ground(0, offset, 1.8, axis)))
    return model


def parallelogram(angle, cranks=2):
    """A coupler on parallel cranks of equal length, crank 2 between the others; all hinges are along z."""
    model = Model("parallelogram", gravity=(0, -9.81, 0))
    c, s = math.cos(angle), math.sin(angle)
    place = (SPAN / 2 + CRANK * c, CRANK * s, 0)
    coupler = model.add("coupler", Body(mass=2, inertia=(0.1, 1, 1), position=place))
    along = {"x": (c, s, 0), "z": (0, 0, 1)}
    for k, x in enumerate((0.0, SPAN, SPAN / 2)[:cranks]):
        place = (x + CRANK / 2 * c, CRANK / 2 * s, 0)
        crank = model.add(f"crank{k}", Body(mass=1, inertia=(0.01, 0.02, 0.02), position=place, orientation=along))
        model.add(f"foot{k}", Revolute(i=crank.at(-CRANK / 2, 0, 0), j=ground(x)))
        model.add(f"head{k}", Revolute(i=crank.at(CRANK / 2, 0, 0), j=coupler.at(x - SPAN / 2, 0, 0)))
    return model


def slider_crank(angle, height=0.4, length=1.5, cross=False):
    """A crank that turns about x and a slider along x, a rod between them on two balls, or on a cross and a ball."""
    model = Model("slider-crank", gravity=(0, 0, -9.81))
    axis = {"z": (1, 0, 0)}
    pin = np.array([0, CRANK * math.cos(angle), CRANK * math.sin(angle)])
    end = np.array([math.sqrt(length**2 - pin[1] ** 2 - (height - pin[2]) ** 2), 0, height])
    crank = model.add(
        "crank",
        Body(
            mass=1, inertia=(0.02, 0.01, 0.02), position=tuple(pin / 2), orientation={"y": tuple(pin), "x": (1, 0, 0)}
        ),
    )
    rod = model.add(
        "rod",
        Body(mass=1, inertia=(0.01, 0.2, 0.2), position=tuple((pin + end) / 2), orientation={"x": tuple(end - pin)}),
    )
    slider = model.add("slider", Body(mass=2, inertia=(0.1, 0.1, 0.1), position=tuple(end)))
    model.add("bearing", Revolute(i=crank.at(0, -CRANK / 2, 0, axis), j=ground(orientation=axis)))
    if cross:  # the crank's arm along x, the rod's across that and the rod
        arm = matrix(model.bodies["rod"].orientation).T @ np.cross(end - pin, (1, 0, 0))
        big_end = Universal(i=rod.at(-length / 2, 0, 0, {"z": tuple(arm)}), j=crank.at(0, CRANK / 2, 0, axis))
    else:
        big_end = Spherical(i=rod.at(-length / 2, 0, 0), j=crank.at(0, CRANK / 2, 0))
    model.add("big_end", big_end)
    model.add("small_end", Spherical(i=rod.at(length / 2, 0, 0), j="slider"))
    model.add("guide", Prismatic(i=slider.at(0, 0, 0, axis), j=ground(0, 0, height, axis)))
    return model
