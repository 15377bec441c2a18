"""Describe a body in other axes, or merge two bodies that a joint fixes together."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from stiffmbs.elements.spatial.orientation import conjugate, from_matrix, product

from ..random_scenes.draft import GROUND, Content, random_axes
from .balance import axes_over_time, body_of
from .change import Change, Channels, vector, with_vector
from .reframed import Frame, axes_of, reframed, tensor_of, three
from .typed import NotLegitimate


def in_other_axes(content: Content, rng: np.random.Generator) -> Change:
    """Return a spatial scene with a body that is described in other axes, from another origin.

    Raises
    ------
    NotLegitimate
        For planar scenes, whose angles may count turns, and when a part or a drive names the body.
    """
    if content.get("dimensions", 2) == 2:
        raise NotLegitimate("the plane has one axis of rotation")
    name = str(rng.choice(list(content["bodies"])))
    body, axes, origin = content["bodies"][name], random_axes(rng), rng.uniform(-0.3, 0.3, 3)
    own = axes_of(body)
    inertia = axes.T @ tensor_of(body) @ axes
    other = {
        **body,
        "inertia": ((inertia + inertia.T) / 2).tolist(),
        "center_of_mass": (axes.T @ (np.array(body.get("center_of_mass", [0.0] * 3)) - origin)).tolist(),
        "position": (np.array(body.get("position", [0.0] * 3)) + own @ origin).tolist(),
        "orientation": (own @ axes).tolist(),
        "omega": (axes.T @ body.get("omega", [0.0] * 3)).tolist(),
    }
    found = reframed(content, {name: Frame(name, origin, axes, 3)}, {**content["bodies"], name: other})
    return Change(f"with {name} in other own axes", found, lambda channels, _: _in_own(channels, name, axes))


def _in_own(channels: Channels, name: str, axes: np.ndarray) -> Channels:
    """Return the quaternion and angular velocities of a body in its original axes."""
    found = dict(channels)
    for kind in ("w", "wd"):
        labels = (f"{kind}x", f"{kind}y", f"{kind}z")
        values = vector(channels, name, labels)
        if values is not None:
            with_vector(found, name, labels, axes @ values)
    if f"{name}.q0" not in channels:
        return found
    back = conjugate(from_matrix(axes))
    rows = np.array([channels[f"{name}.q{k}"] for k in range(4)]).T
    for k, series in enumerate(np.array([product(row, back) for row in rows]).T):
        found[f"{name}.q{k}"] = series
    return found


def as_one_body(content: Content, rng: np.random.Generator) -> Change:
    """Return a scene in which two bodies fixed together by a joint are merged, with the axes of the first.

    Raises
    ------
    NotLegitimate
        When there is no such pair, another joint connects it, or a part or a drive names one of the bodies.
    """
    pairs = [
        (key, body_of(joint["i"]), body_of(joint["j"]))
        for key, joint in content.get("joints", {}).items()
        if joint["type"] == "fixed" and GROUND not in (body_of(joint["i"]), body_of(joint["j"]))
    ]
    if not pairs:
        raise NotLegitimate("no two bodies are fixed together")
    weld, first, second = pairs[int(rng.integers(len(pairs)))]
    _apart_otherwise(content, weld, {first, second})
    dimensions = content.get("dimensions", 2)
    bodies, joint = content["bodies"], content["joints"][weld]
    at = {end: _placed(joint[end]) for end in "ij"}
    axes = at["i"][1] @ at["j"][1].T  # of the second body in those of the first
    origin = at["i"][0] - axes @ at["j"][0]
    one, other = (three(bodies[name].get("center_of_mass", [])) for name in (first, second))
    masses = [bodies[name]["mass"] for name in (first, second)]
    centres = [one, origin + axes @ other]
    centre = np.average(centres, axis=0, weights=masses)
    whole = _composite(
        bodies[first], masses, centres, [tensor_of(bodies[first]), axes @ tensor_of(bodies[second]) @ axes.T]
    )
    others = {first: whole, **{name: body for name, body in bodies.items() if name not in (first, second)}}
    turn = bodies[first].get("angle", 0.0) - bodies[second].get("angle", 0.0)
    frames = {
        first: Frame(first, centre, np.eye(3), dimensions),
        second: Frame(first, -axes.T @ (origin - centre), axes.T, dimensions, turn),
    }
    rest = {key: each for key, each in content["joints"].items() if key != weld}
    found = reframed({**content, "joints": rest}, frames, others)

    def back(channels: Channels, _: np.ndarray) -> Channels:
        """Return the channels of the first body from those of the whole."""
        if f"{first}.x" not in channels:
            return channels
        kept = {name: series for name, series in channels.items() if name not in _accelerations(first)}
        arm = np.einsum("nij,j->in", axes_over_time(channels, first), one - centre)
        with_vector(kept, first, ("x", "y", "z"), vector(channels, first, ("x", "y", "z")) + arm)
        spin = _spin(channels, first)
        with_vector(
            kept, first, ("vx", "vy", "vz"), vector(channels, first, ("vx", "vy", "vz")) + np.cross(spin, arm, axis=0)
        )
        for key, body in _equations(rest, (first, second), bodies).items():
            own = (centres[1] if body == second else one) - centre
            _about(kept, key, np.einsum("nij,j->in", axes_over_time(channels, first), own))
        return kept

    return Change(f"with {first} and {second} as one body", found, back)


def _apart_otherwise(content: Content, weld: str, pair: set[str]) -> None:
    """Raise NotLegitimate where another element acts between two bodies, or a part is mounted on one."""
    for name, part in content.get("use", {}).items():
        if pair & {body_of(mount) for mount in part.get("mounts", {}).values()}:
            raise NotLegitimate(f"{name} is mounted on one of {' and '.join(sorted(pair))}")
    for section in ("joints", "forces"):
        for key, element in content.get(section, {}).items():
            ends = {body_of(element[end]) for end in "ij" if end in element}
            named = set(re.findall(r"\w+", str(element.get("zero", ""))))
            if key != weld and (ends == pair or pair <= named or weld in element.values()):
                raise NotLegitimate(f"{key} acts between {' and '.join(sorted(pair))}")


def _composite(first: Content, masses: list[float], centres: list[np.ndarray], tensors: list[np.ndarray]) -> Content:
    """Return the union of two bodies, with its centre of mass as origin, and the axes and motion of the first."""
    centre = np.average(centres, axis=0, weights=masses)
    whole = np.zeros((3, 3))
    for mass, place, tensor in zip(masses, centres, tensors, strict=True):
        arm = place - centre
        whole += tensor + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    own = axes_of(first)
    arm = centre - centres[0]
    omega: Any = first.get("omega", 0.0)
    found = {key: each for key, each in first.items() if key != "center_of_mass"} | {"mass": sum(masses)}
    position = three(first.get("position", [])) + own @ centre
    if "angle" in first or np.ndim(first["inertia"]) == 0:
        velocity = three(first.get("velocity", [])) + np.cross([0.0, 0.0, omega], own @ arm)
        return found | {"inertia": whole[2, 2], "position": position[:2].tolist(), "velocity": velocity[:2].tolist()}
    velocity = three(first.get("velocity", [])) + own @ np.cross(three(np.atleast_1d(omega)), arm)
    whole = (whole + whole.T) / 2
    return found | {"inertia": whole.tolist(), "position": position.tolist(), "velocity": velocity.tolist()}


def _equations(joints: Content, pair: tuple[str, str], bodies: Iterable[str]) -> dict[str, str]:
    """Return the equations whose reactions are on one of two bodies, that which is named first, with its name."""
    found: dict[str, str] = {}
    for key, joint in joints.items():
        if joint["type"] in ("equation", "velocity_equation"):
            first = next((name for name in re.findall(r"\w+", joint["zero"]) if name in bodies), "")
            found |= {key: first} if first in pair else {}
    return found


def _about(channels: Channels, key: str, arm: np.ndarray) -> None:
    """Replace the moment of a reaction by that about a point at `arm` from its point of reference, shape (3, n)."""
    force: Any = vector(channels, key, ("fx", "fy", "fz"))
    moments = dict(zip(("tx", "ty", "tz"), np.cross(arm, force, axis=0), strict=True))
    for label, part in {**moments, "torque": moments["tz"]}.items():
        if f"{key}.{label}" in channels:
            channels[f"{key}.{label}"] = channels[f"{key}.{label}"] - part


def _placed(marker: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return a marker's point and axes on its body."""
    found = {} if isinstance(marker, str) else marker
    return three(found.get("point", [])), axes_of(found)


def _spin(channels: Channels, name: str) -> np.ndarray:
    """Return a body's angular velocity along the ground's axes, shape (3, n)."""
    if f"{name}.omega" in channels:
        zero = np.zeros_like(channels[f"{name}.omega"])
        return np.array([zero, zero, channels[f"{name}.omega"]])
    own = np.array([channels[f"{name}.w{axis}"] for axis in "xyz"])
    return np.einsum("nij,jn->in", axes_over_time(channels, name), own)


def _accelerations(name: str) -> set[str]:
    return {f"{name}.a{axis}" for axis in "xyz"}
