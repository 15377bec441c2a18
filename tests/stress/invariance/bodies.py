"""Add an idle body to a scene, or split a body into two that are fixed together."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from ..random_scenes.draft import Content, about_z, random_axes
from .change import Change, Channels
from .reframed import Frame, Reframed, axes_of, tensor_of, three, turned
from .typed import class_of, mapped

IDLE, TWIN, WELD = "idle", "twin", "weld"


def with_idle_body(content: Content, rng: np.random.Generator) -> Change:
    """Return a scene with an additional body that falls freely, or swings on a separate spring."""
    dimensions = content.get("dimensions", 2)
    found = copy.deepcopy(content)
    inertia: Any = [0.5, 0.6, 0.7] if dimensions == 3 else 0.5
    place = [float(rng.uniform(2, 3)) for _ in range(dimensions)]
    found["bodies"] = {IDLE: {"mass": 1.5, "inertia": inertia, "position": place}, **found["bodies"]}
    if rng.random() < 0.5:
        spring = {
            "type": "spring_damper",
            "i": IDLE,
            "j": "ground",
            "stiffness": 40.0,
            "damping": 1.0,
            "free_length": 1.0,
        }
        found.setdefault("forces", {})["hangs"] = spring
    return Change("with an idle body", found, lambda channels, _: _others(channels, (IDLE, "hangs"), energy=False))


def with_a_body_in_two(content: Content, rng: np.random.Generator) -> Change:
    """Return a scene with a body split into two that are fixed together; some elements act on the second one."""
    dimensions = content.get("dimensions", 2)
    found = copy.deepcopy(content)
    name = str(rng.choice(list(content["bodies"])))
    part = float(rng.uniform(0.2, 0.8))
    axes = random_axes(rng) if dimensions == 3 else about_z(float(rng.uniform(-3, 3)))
    body, twin = _halves(found["bodies"][name], part, axes, dimensions)
    found["bodies"] = {name: body, TWIN: twin, **{key: each for key, each in found["bodies"].items() if key != name}}
    place = {"body": name, "point": body.get("center_of_mass", [0.0] * dimensions)}
    joints = found.setdefault("joints", {})
    joints[WELD] = {"type": "fixed", "i": {"body": TWIN, **turned(axes.T, dimensions)}, "j": place}
    centre = three(body.get("center_of_mass", []))
    mapper = Reframed({name: Frame(TWIN, centre, axes, dimensions, float(np.arctan2(axes[1, 0], axes[0, 0])))})
    meshed = {
        entry[key] for entry in joints.values() for key in ("joint_1", "joint_2", "rack", "pinion") if key in entry
    }
    for section in ("joints", "forces"):
        for key, entry in content.get(section, {}).items():
            if key not in meshed and rng.random() < 0.5:
                found[section][key] = mapped(entry, class_of(section, entry, dimensions), mapper)
    return Change(
        f"with {name} as two bodies that are fixed together", found, lambda c, _: _others(c, (TWIN, WELD), energy=True)
    )


def _halves(body: Content, part: float, axes: np.ndarray, dimensions: int) -> tuple[Content, Content]:
    """Return two bodies with the same common centre of mass as one, the second with different axes."""
    mass = body["mass"]
    first, second = dict(body, mass=(1 - part) * mass), dict(body, mass=part * mass)
    centre = np.array(second.pop("center_of_mass", [0.0] * dimensions))
    if dimensions == 2:
        first["inertia"], second["inertia"] = (1 - part) * body["inertia"], part * body["inertia"]
        second["angle"] = body.get("angle", 0.0) + float(np.arctan2(axes[1, 0], axes[0, 0]))
        return first, second
    tensor = tensor_of(body)
    first["inertia"] = ((1 - part) * tensor).tolist()
    turned = part * axes.T @ tensor @ axes
    second["inertia"] = ((turned + turned.T) / 2).tolist()
    own = axes_of(body)
    second["orientation"] = (own @ axes).tolist()
    second["position"] = (np.array(body.get("position", [0.0, 0.0, 0.0])) + own @ centre).tolist()
    if "omega" in body:
        second["omega"] = (axes.T @ body["omega"]).tolist()
    return first, second


def _others(channels: Channels, owners: tuple[str, ...], energy: bool) -> Channels:
    """Return the channels of all other elements."""
    return {
        name: series for name, series in channels.items()
        if name.rpartition(".")[0] not in owners and (energy or not name.startswith("energy."))
    }  # fmt: skip
