"""Newton-Euler equations of each body of a run, from the data of the scene and the channels alone."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..random_scenes.draft import GROUND, Content, about_z
from .change import Channels
from .comparison import Difference
from .reframed import tensor_of, three
from .ways import Found

Wrench = tuple[np.ndarray, np.ndarray]
"""Force and its torque about a body's centre of mass, in ground axes, each of shape (3, n)."""
RELATIVE = 1e-8
"""Allowed residual relative to the largest term: output accelerations and reactions solve one linear system."""
DRIFT, BARS = 1e-4, 3.0
"""Allowed difference between velocities and integrated accelerations: relative, and in error bars of the integrals."""
FINE, COARSE = (1.0, 4.0, 2.0, 4.0, 1.0), (2.0, 0.0, 8.0, 0.0, 2.0)
"""Simpson's weights over four intervals, and over two double intervals, in thirds of an interval."""
LEAST = 1e-2
"""Smallest scale of an equation, relative to the largest term of all bodies."""


def balance(content: Content, found: Found) -> Difference:
    """Return the body with the largest residual of its equations, relative to the allowed one.

    Bodies are skipped if the wrenches of one of their elements do not follow from its channels: a relation of several joints, an
    equation by formula, or a library part.

    Parameters
    ----------
    content : dict
        Content of a scene.
    found : Found
        Results of its run.
    """
    sizes = {"force": 0.0, "torque": 0.0}
    missed: dict[tuple[str, str], tuple[float, float]] = {}
    for name in content["bodies"]:
        for label, gap, bar in _drifts(content, found, name):
            missed[name, label] = gap, bar
    for name in _complete(content):
        for label, terms in _terms(content, found.channels, name):
            size = max(float(np.max(np.abs(term))) for term in terms)
            sizes[label] = max(sizes[label], size)
            missed[name, label] = float(np.max(np.abs(sum(terms)))), size
    worst = Difference(0.0, "", "no body is assessed")
    for (name, label), (gap, size) in missed.items():
        allowed = size if label not in sizes else RELATIVE * max(size, LEAST * sizes[label], 1e-6)
        if not gap / allowed <= worst.ratio:
            what = f"{gap:.3g} against {allowed:.3g}, the largest term is {size:.3g}"
            worst = Difference(gap / allowed, name, f"the equation of its {label} is missed by {what}")
    return worst


def _drifts(content: Content, found: Found, name: str) -> Iterator[tuple[str, float, float]]:
    """Yield the differences between a body's velocity changes and its integrated accelerations, with their bounds.

    The integrals are Simpson's over groups of four intervals.  Their error bar is the sum of all differences from Simpson's
    over two double intervals.  Scenes with impacts, which may fall between output times, are left out.
    """
    if any("impact" in force["type"] or "contact" in force["type"] for force in content.get("forces", {}).values()):
        return
    labels = {"v": "a", "w": "wd"} if content.get("dimensions", 2) == 3 else {"v": "a", "omega": "alpha"}
    groups = (len(found.time) - 1) // 4
    step = found.time[1] - found.time[0]
    for rate, slope in labels.items():
        for axis in "xyz"[: content.get("dimensions", 2)] if rate != "omega" else ("",):
            v, a = (found.channels[f"{name}.{each}{axis}"][: 4 * groups + 1] for each in (rate, slope))
            parts = np.array([a[4 * k : 4 * k + 5] for k in range(groups)])
            fine, coarse = (step / 3 * parts @ np.array(weights) for weights in (FINE, COARSE))
            size = float(np.max(np.abs(v)) + 4 * groups * step * np.max(np.abs(a)))
            bound = DRIFT * max(size, 1e-6) + BARS * float(np.sum(np.abs(fine - coarse)))
            yield f"velocity {rate}{axis}", float(abs(v[-1] - v[0] - np.sum(fine))), bound


def _complete(content: Content) -> Iterator[str]:
    """Yield the bodies for which all acting wrenches follow from channels."""
    incomplete = set()
    for element in _elements(content).values():
        if _ends(content, element) is None:
            incomplete |= _named(content, element)
    incomplete |= {name for name in content["bodies"] if f'"{name}"' in json.dumps(content.get("use", {}))}
    yield from (name for name in content["bodies"] if name not in incomplete)


def _elements(content: Content) -> Content:
    return {**content.get("joints", {}), **content.get("forces", {})}


def _ends(content: Content, element: Content) -> tuple[Any, Any] | None:
    """Return the markers whose bodies take the wrench of an element and its opposite, or None if there are others."""
    if element["type"] in ("equation", "velocity_equation") or "coordinate" in element:
        return None
    if "joint" in element:
        return _ends(content, content["joints"][element["joint"].partition(".")[0]])
    if "i" not in element:
        return None
    return element["i"], element.get("j", GROUND)


def _named(content: Content, element: Content) -> set[str]:
    """Return the bodies that an element refers to, directly or by joints."""
    joints = [content["joints"].get(str(part).partition(".")[0], {}) for part in element.values()]
    text = json.dumps([element, *joints])
    return {name for name in content["bodies"] if name in text}


def _terms(content: Content, channels: Channels, name: str) -> Iterator[tuple[str, list[np.ndarray]]]:
    """Yield the terms of a body's force and torque balance, which add up to zero."""
    body = content["bodies"][name]
    centre, accelerated = (_motion(content, channels, name, label) for label in ("", "a"))
    acting = list(_wrenches(content, channels, name, centre))
    n = centre.shape[1]
    weight = body["mass"] * np.outer(three(content.get("gravity", [])), np.ones(n))
    yield "force", [*(force for force, _ in acting), weight, -body["mass"] * accelerated]
    if content.get("dimensions", 2) == 2:
        inertial = np.array([np.zeros(n), np.zeros(n), body["inertia"] * channels[f"{name}.alpha"]])
        yield "torque", [*(torque[2:] for _, torque in acting), -inertial[2:]]
        return
    tensor = tensor_of(body)
    spin, rate = (np.array([channels[f"{name}.{label}{axis}"] for axis in "xyz"]) for label in ("w", "wd"))
    axes = axes_over_time(channels, name)
    own = tensor @ rate, np.cross(spin, tensor @ spin, axis=0)
    yield "torque", [*(torque for _, torque in acting), *(-np.einsum("nij,jn->in", axes, part) for part in own)]


def _motion(content: Content, channels: Channels, name: str, label: str) -> np.ndarray:
    """Return the position or the acceleration (``a``) of a body's centre of mass over time, shape (3, n)."""
    found = [channels[f"{name}.{label}{axis}"] for axis in "xyz"[: content.get("dimensions", 2)]]
    return np.array([*found, np.zeros_like(found[0])][:3])


def _wrenches(content: Content, channels: Channels, name: str, centre: np.ndarray) -> Iterator[Wrench]:
    """Yield the wrenches of all elements on a body."""
    for key, element in _elements(content).items():
        ends = _ends(content, element)
        if ends is None:
            continue
        first, second = ends
        apart = element.get("axes") == GROUND  # the force acts at each body's own marker
        sides = [(1.0, first, first), (-1.0, second, second if apart else first)]
        acting = [(sign, place) for sign, end, place in sides if body_of(end) == name]
        if not acting:
            continue
        force = np.array([channels.get(f"{key}.f{axis}", 0.0 * centre[0]) for axis in "xyz"])
        torque = np.array([channels.get(f"{key}.t{axis}", 0.0 * centre[0]) for axis in "xyz"])
        torque[2] += channels.get(f"{key}.torque", 0.0)
        for sign, place in acting:
            arm = _point(content, channels, place) - centre
            yield sign * force, sign * (torque + np.cross(arm, force, axis=0))


def body_of(marker: Any) -> str:
    """Return the body of a marker."""
    return str(marker if isinstance(marker, str) else marker["body"])


def _point(content: Content, channels: Channels, marker: Any) -> np.ndarray:
    """Return a marker's point over time, shape (3, n)."""
    name = body_of(marker)
    point = np.zeros(3) if isinstance(marker, str) else three(marker.get("point", []))
    if name == GROUND:
        return point[:, None]
    from_centre = point - three(content["bodies"][name].get("center_of_mass", []))
    return np.asarray(
        _motion(content, channels, name, "") + np.einsum("nij,j->in", axes_over_time(channels, name), from_centre)
    )


def axes_over_time(channels: Channels, name: str) -> np.ndarray:
    """Return the axes of a body over time, shape (n, 3, 3), from its quaternion or angle."""
    if f"{name}.angle" in channels:
        return np.array([about_z(float(angle)) for angle in channels[f"{name}.angle"]])
    w, x, y, z = (channels[f"{name}.q{k}"] for k in range(4))
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
