"""Random contacts: shapes that are about to touch."""

from __future__ import annotations

import numpy as np

from .draft import Content, Draft, about_z, axes_with_z

GAP = 0.06
"""m, at most."""
RADIUS = 0.2
"""m, at most."""


def add_contact(draft: Draft) -> str:
    """Add a contact of a circle with a line, a circle or a hole."""
    i, j = draft.two_bodies()
    radius, law = draft.uniform(0.02, RADIUS), _law(draft)
    surface = draft.choice(["line", "circle", "hole"])
    angle = draft.uniform(-3, 3)
    way, at = np.array([np.cos(angle), np.sin(angle), 0.0]), draft.near(i, 0.1)
    there, fields = _surface(draft, at, way, radius, surface)
    markers = {"i": draft.marker(i, at), "j": draft.marker(j, there, about_z(angle - np.pi / 2))}
    return draft.add("forces", "contact", type="contact", **markers, radius=radius, **fields, **law)


def add_sphere_contact(draft: Draft) -> str:
    """Add a contact of a sphere with a plane, a sphere or a hollow sphere."""
    i, j = draft.two_bodies()
    radius, law = draft.uniform(0.02, RADIUS), _law(draft)
    surface = draft.choice(["plane", "sphere", "hollow"])
    way, at = _direction(draft), draft.near(i, 0.1)
    there, fields = _surface(draft, at, way, radius, surface)
    markers = {"i": draft.marker(i, at), "j": draft.marker(j, there, axes_with_z(way))}
    return draft.add("forces", "contact", type="sphere_contact", **markers, radius=radius, **fields, **law)


def _surface(draft: Draft, at: np.ndarray, way: np.ndarray, radius: float, surface: str) -> tuple[np.ndarray, Content]:
    """Return the position of the surface's marker at a gap from the body, and its fields."""
    gap = draft.uniform(0.005, GAP)
    if surface in ("line", "plane"):
        return at - (radius + gap) * way, {"surface": surface}
    other = draft.uniform(0.1, 0.5) + (1.0 if surface in ("hole", "hollow") else 0.0)
    distance = other - radius - gap if surface in ("hole", "hollow") else other + radius + gap
    return at - distance * way, {"surface": surface, "surface_radius": other}


def _law(draft: Draft) -> Content:
    """Return stiffness, dissipation and friction of a contact."""
    law: Content = {
        "stiffness": draft.uniform(2e3, 2e4),
        "exponent": draft.choice([1.0, 1.5, 2.0]),
        "dissipation": draft.uniform(0, 0.5),
    }
    if draft.chance(0.3):
        law |= {"friction": draft.uniform(0.05, 0.3), "stiction_velocity": draft.uniform(0.05, 0.2)}
    return law


def add_plane_impact(draft: Draft, kind: str) -> str:
    """Add an impact of a box, cylinder or ellipsoid with a plane."""
    i, j = draft.two_bodies()
    sizes = [draft.uniform(0.05, RADIUS) for _ in range(3)]
    way, at, axes = _direction(draft), draft.near(i, 0.1), draft.axes()
    fields: Content = dict(zip("xyz", sizes, strict=True))
    along = np.abs(axes.T @ way)
    match kind:
        case "box":
            reach = float(along @ sizes) / 2
        case "ellipsoid":
            reach = float(np.linalg.norm(along * sizes))
        case _:
            fields = {"radius": sizes[0], "length": sizes[1]}
            reach = float(along[2] * sizes[1] / 2 + np.hypot(along[0], along[1]) * sizes[0])
    there = at - (reach + draft.uniform(0.005, GAP)) * way
    markers = {"i": draft.marker(i, at, axes), "j": draft.marker(j, there, axes_with_z(way))}
    return draft.add("forces", "impact", type=f"{kind}_plane_impact", **markers, **fields, **_impact(draft))


def add_sphere_impact(draft: Draft, kind: str) -> str:
    """Add an impact of a sphere with a box, a cylinder or a sphere."""
    i, j = draft.two_bodies()
    radius, size = draft.uniform(0.05, RADIUS), draft.uniform(0.1, 0.3)
    way, at = _direction(draft), draft.near(i, 0.1)
    fields: Content = {
        "box": dict.fromkeys("xyz", 2 * size), "cylinder": {"cylinder_radius": size, "cylinder_length": 2 * size},
        "sphere": {"other_radius": size},
    }[kind]  # fmt: skip
    there = at - (radius + size + draft.uniform(0.005, GAP)) * way
    markers = {"i": draft.marker(i, at), "j": draft.marker(j, there, axes_with_z(way))}
    return draft.add(
        "forces", "impact", type=f"sphere_{kind}_impact", **markers, radius=radius, **fields, **_impact(draft)
    )


def add_capsule_impact(draft: Draft) -> str:
    """Add an impact of two capsules."""
    i, j = draft.two_bodies()
    radii, lengths = ([draft.uniform(low, high) for _ in range(2)] for low, high in ((0.03, RADIUS), (0.1, 0.4)))
    way, at = _direction(draft), draft.near(i, 0.1)
    reach = sum(radii) + sum(lengths) / 2
    markers = {"i": draft.marker(i, at, draft.axes()), "j": draft.marker(j, at - (reach + 0.01) * way, draft.axes())}
    sizes = {"radius": radii[0], "length": lengths[0], "other_radius": radii[1], "other_length": lengths[1]}
    return draft.add("forces", "impact", type="capsule_impact", **markers, **sizes, **_impact(draft))


def add_solid_impact(draft: Draft) -> str:
    """Add an impact of two ellipsoids, boxes or cylinders."""
    i, j = draft.two_bodies()
    shapes = [draft.choice(["ellipsoid", "box", "cylinder"]) for _ in range(2)]
    sizes = [[draft.uniform(0.1, 0.3) for _ in range(3)] for _ in range(2)]
    for shape, size in zip(shapes, sizes, strict=True):
        if shape == "cylinder":
            size[1] = size[0]
    way, at = _direction(draft), draft.near(i, 0.1)
    reach = sum(max(size) for size in sizes)
    markers = {"i": draft.marker(i, at, draft.axes()), "j": draft.marker(j, at - (reach + 0.01) * way, draft.axes())}
    fields = {"i_shape": shapes[0], "j_shape": shapes[1], "i_size": sizes[0], "j_size": sizes[1]}
    return draft.add("forces", "impact", type="solid_impact", **markers, **fields, **_impact(draft))


def _impact(draft: Draft) -> Content:
    """Return the law of an impact, sometimes with friction."""
    law: Content = {
        "stiffness": draft.uniform(2e3, 2e4), "exponent": draft.choice([1.5, 2.0]), "damping": draft.uniform(1, 10),
        "depth": draft.uniform(1e-3, 5e-3),
    }  # fmt: skip
    if draft.chance(0.3):
        law |= {"static_friction": 0.3, "friction": 0.2, "stiction_velocity": 0.1, "friction_velocity": 0.5}
    return law


def _direction(draft: Draft) -> np.ndarray:
    """Return a unit vector in space."""
    found = draft.rng.standard_normal(3)
    return np.array(found / np.linalg.norm(found))
