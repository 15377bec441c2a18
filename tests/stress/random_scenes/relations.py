"""Random relations, drives and equations on coordinates of joints and bodies."""

from __future__ import annotations

import numpy as np

from .bodies import add_body
from .draft import Coordinate, Draft, Unfit
from .joints import add_joint
from .laws import law_of_time


def add_coupler(draft: Draft) -> str:
    """Couple two coordinates of joints."""
    first, second = _take(draft), _take(draft)
    _use_freedom(draft)
    scale = draft.choice([1.0, -1.0, draft.uniform(0.3, 2)])
    return draft.add("joints", "coupler", type="coupler", joint_1=first.joint, joint_2=second.joint, scale=scale)


def add_gear(draft: Draft) -> str:
    """Add two meshing gear wheels on one carrier."""
    carrier = draft.choice(draft.poses)
    first, second = (_wheel(draft, carrier, "revolute") for _ in range(2))
    _use_freedom(draft)
    ratio = draft.choice([-1, 1]) * draft.uniform(0.5, 2)
    return draft.add("joints", "gear", type="gear", joint_1=first, joint_2=second, ratio=ratio)


def add_rack_and_pinion(draft: Draft) -> str:
    """Add a rack and a pinion on one carrier."""
    carrier = draft.choice(draft.poses)
    rack, pinion = _wheel(draft, carrier, "prismatic"), _wheel(draft, carrier, "revolute")
    _use_freedom(draft)
    radius = draft.choice([-1, 1]) * draft.uniform(0.1, 0.4)
    return draft.add("joints", "mesh", type="rack_and_pinion", rack=rack, pinion=pinion, pitch_radius=radius)


def add_drive(draft: Draft) -> str:
    """Drive a coordinate of a joint, or one of a body without joints, by a position or a velocity over time."""
    size = 0.5
    if draft.coordinates and draft.chance(0.7):
        coordinate = _take(draft)
        driven = {"joint": coordinate.joint}
        _use_freedom(draft)
        if coordinate.sort == "angle" and draft.chance(0.5):
            return draft.add("joints", "drive", type="drive", **driven, position=law_of_time(draft, size))
    else:
        held = {joint[key]["body"] for joint in draft.section("joints").values() for key in "ij" if key in joint}
        body, axis = (
            draft.choice(name for name in draft.bodies if name not in held),
            draft.choice("xyz"[: draft.dimensions]),
        )
        driven = {"coordinate": f"{body}.{axis}"}
        _use_freedom(draft)
    return draft.add("joints", "drive", type="drive", **driven, velocity=f"{draft.uniform(-0.5, 0.5)!r}*cos(3*t)")


def add_equation(draft: Draft) -> str:
    """Prescribe a distance of two bodies along an axis as a smooth function of another one."""
    body, other = draft.two_bodies()
    axis, across = draft.choice("xy"), draft.choice("xy")
    A, B = draft.uniform(0.1, 0.5), draft.uniform(0.5, 2)
    start = _origin(draft, body) - _origin(draft, other)
    own, place = (float(start["xy".index(name)]) for name in (axis, across))
    value = own - A * float(np.sin(B * place))
    _use_freedom(draft)
    law = f"{A!r}*sin({B!r}*d{across}({body}, {other}))"
    return draft.add("joints", "equation", type="equation", zero=f"d{axis}({body}, {other}) - {law} - ({value!r})")


def add_velocity_equation(draft: Draft) -> str:
    """Constrain the velocity of a body along one of its axes, like a knife edge."""
    body = draft.choice(draft.bodies)
    _use_freedom(draft)
    axis = draft.choice("xy")
    return draft.add("joints", "edge", type="velocity_equation", zero=f"v{axis}({body}, ground, {body})")


def _origin(draft: Draft, body: str) -> np.ndarray:
    return draft.poses[body].point


def _wheel(draft: Draft, carrier: str, kind: str) -> str:
    """Add a body on a carrier and return the name of the joint."""
    name = add_joint(draft, kind, add_body(draft, "wheel"), carrier)
    draft.coordinates.pop()
    return name


def _take(draft: Draft) -> Coordinate:
    found: Coordinate = draft.choice(draft.coordinates)
    draft.coordinates.remove(found)
    return found


def _use_freedom(draft: Draft) -> None:
    if draft.freedoms <= 1:
        raise Unfit
    draft.freedoms -= 1
