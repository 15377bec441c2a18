"""Random scenes with line bodies, flexible bodies, tyres of version 6, suspension elements and formulas of joint coordinates."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs import __file__ as package
from stiffmbs.elements.tyres.coefficients import TyreProperties

from .bodies import SIZE
from .draft import Content, Draft, Pose, Unfit, about_z, random_axes
from .features import Features
from .parts import SPRINGS, add_spring
from .scene import add_forces, add_tree, beginning, without_empty_sections
from .tyres import PROPERTIES, add_tyre

ROD = Path(package).parent.parent / "examples" / "flexible" / "flexible_rod.vtu"
ROD_LENGTH = 0.3
"""Distance of its interfaces, m."""
VERSION_6 = {"NOMPRES": 2.2e5, "PPX1": -0.3, "PPX2": 0.2, "PPY1": 0.4, "PPY2": 1.2, "PPY3": -0.1, "PPZ1": -0.4, "Q_V1": 1e-4, "Q_FCX": 0.1, "Q_FCY": 0.1}  # fmt: skip
"""Coefficients of versions 6.1 and 6.2 that 5.2 does not have."""


def extended_scene(rng: np.random.Generator) -> Content:
    """Return the content of a random scene with one to three of these elements among others.

    Parameters
    ----------
    rng : Generator
    """
    dimensions = int(rng.integers(2, 4))
    draft = Draft(rng, dimensions, replace(Features(), redundant=False, loops=False, parts=False, tyres=False))
    draft.content = beginning(draft)
    makers = [add_line_body, add_line_body, add_joint_law]
    makers += [add_flexible_rod, add_tyre_of_version_6, _add_some_spring] if draft.in_space else []
    for _ in range(int(rng.integers(1, 3))):
        maker = draft.choice(makers)
        if maker is add_joint_law:
            add_tree(draft)
        try:
            maker(draft)
        except Unfit:
            continue
    if not draft.bodies:
        add_tree(draft)
    add_forces(draft, int(rng.integers(1, 3)))
    return without_empty_sections(draft)


def add_line_body(draft: Draft) -> str:
    """Add a soft beam that a joint holds at its start, sometimes with a body at its end."""
    start, length = draft.place(SIZE), draft.uniform(0.4, 1.0)
    axes = random_axes(draft.rng) if draft.in_space else about_z(draft.uniform(-3, 3))
    end = start + length * axes[:, 0]
    section = draft.choice(
        [
            {"type": "circle", "diameter": draft.uniform(0.02, 0.04)},
            {"type": "rectangle", "width": draft.uniform(0.02, 0.05), "height": draft.uniform(0.02, 0.05)},
        ]
    )
    fields: Content = {
        "start": start[: draft.dimensions].tolist(), "end": end[: draft.dimensions].tolist(), "elements": int(draft.rng.integers(2, 5)),
        "material": {"E": draft.uniform(3e6, 3e7), "nu": 0.3, "density": 1100.0}, "damping": draft.uniform(2e-3, 5e-3),
    }  # fmt: skip
    if draft.in_space:
        fields["up"] = axes[:, 2].tolist()
    rod = draft.add("bodies", "rod", type="beam", **fields)
    draft.content["bodies"][rod]["section"] = section
    for name, point in (("start", start), ("end", end)):
        draft.poses[f"{rod}.{name}"] = Pose(point, axes)
    draft.freedoms += 3 * (draft.dimensions - 1)
    _hold(draft, f"{rod}.start", ("fixed", "spherical", "universal") if draft.in_space else ("fixed", "revolute"))
    return rod


def add_flexible_rod(draft: Draft) -> str:
    """Add a flexible rod with two interfaces, one of which a joint holds."""
    axes, origin = random_axes(draft.rng), draft.place(SIZE)
    rod = draft.add(
        "bodies", "bar", type="flexible", mesh=str(ROD), units={"length": "1 mm"}, modes=2, damping=draft.uniform(0.02, 0.1),
        material={"E": 2e11, "nu": 0.3, "density": 7870.0},
        interfaces={
            name: {"plane": {"point": [way, 0, 0], "normal": [1, 0, 0]}, "type": "average"}
            for name, way in (("crank_end", 0.0), ("slider_end", ROD_LENGTH))
        },
        position=origin.tolist(), orientation=axes.tolist(),
    )  # fmt: skip
    for name, way in (("crank_end", 0.0), ("slider_end", ROD_LENGTH)):
        draft.poses[f"{rod}.{name}"] = Pose(origin + way * axes[:, 0], axes)
    draft.freedoms += 6
    _hold(draft, f"{rod}.crank_end", ("spherical", "universal", "revolute"))
    return rod


def _hold(draft: Draft, name: str, kinds: tuple[str, ...]) -> None:
    """Hold a node by a joint at its own place, on the ground or an earlier body."""
    others = [other for other in draft.poses if other.partition(".")[0] != name.partition(".")[0]]
    kind, pose = draft.choice(kinds), draft.poses[name]
    other = draft.choice(others)
    own, there = draft.marker(name, pose.point, pose.axes), draft.marker(other, pose.point, pose.axes)
    if kind == "universal":
        quarter = pose.axes @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
        own = draft.marker(name, pose.point, quarter)
    draft.add("joints", "hold", type=kind, i=own, j=there)


def add_joint_law(draft: Draft) -> str:
    """Add a force by formula of a coordinate of a joint and its rate, and requests of both."""
    coordinate = draft.choice(draft.coordinates)
    sort = coordinate.joint if "." in coordinate.joint else f"{coordinate.joint}.{coordinate.sort}"
    law = f"-{draft.uniform(2, 8)!r}*{sort} - {draft.uniform(0.2, 1)!r}*{sort}_rate"
    components: list[Any] = draft.vector(3.0)
    components[int(draft.rng.integers(draft.dimensions))] = law
    draft.section("requests")["way"] = sort
    draft.section("requests")["faster"] = f"{sort}_rate"
    return draft.add("forces", "law", type="force", i=coordinate.i if coordinate.i != "ground" else coordinate.j, force=components)  # fmt: skip


@cache
def _version_6() -> Content:
    """Return the coefficients of the tyre of examples/car.tir with some of version 6."""
    return {**TyreProperties.from_file(PROPERTIES).coefficients, **VERSION_6}


def add_tyre_of_version_6(draft: Draft) -> str:
    """Add a wheel with a tyre of version 6.1 or 6.2."""
    draft.content["gravity"] = [0.0, 0.0, -9.81]
    tyre = add_tyre(draft, "magic_formula_tyre")
    draft.content["forces"][tyre]["properties"] = {
        "coefficients": _version_6(),
        "version": draft.choice(["6.1", "6.2"]),
    }
    draft.content["forces"][tyre]["pressure"] = draft.uniform(1.8e5, 2.6e5)
    return tyre


def _add_some_spring(draft: Draft) -> str:
    return add_spring(draft, draft.choice(SPRINGS))
