"""Two free bodies in space with an element between them, and what the element must keep."""

from __future__ import annotations

import numpy as np

from stiffmbs import compile_model
from stiffmbs.compile.state import State
from stiffmbs.elements.spatial.orientation import conjugate, matrix, product, rotated
from stiffmbs.spatial import Body, Model


def turned(axis, angle):
    """The unit quaternion of a turn about an axis, rad."""
    return (np.cos(angle / 2), *(np.sin(angle / 2) * np.array(axis) / np.linalg.norm(axis)))


def two_bodies(element, seed, apart=(0.7, -0.4, 0.5), turn=((1, 2, 3), 0.6), **fields):
    """Two free bodies in motion, marker i of `element` being `apart` from marker j and turned against it, in j's axes."""
    rng = np.random.default_rng(seed)
    model = Model()
    unit = [tuple(p / np.linalg.norm(p)) for p in rng.normal(size=(3, 4))]
    on_a, on_b = rng.uniform(-0.3, 0.3, (2, 3))
    place_b, along = rng.uniform(-1, 1, (2, 3))
    p_j = product(unit[0], unit[1])
    p_i = product(p_j, turned(*turn))
    p_a = product(p_i, conjugate(unit[2]))
    place_a = place_b + rotated(unit[0], on_b) + rotated(p_j, apart) - rotated(p_a, on_a)
    i = {"point": tuple(on_a), "orientation": unit[2]}
    j = {"point": tuple(on_b), "orientation": unit[1]}
    for name, place, p, mass, markers in (("a", place_a, p_a, 1.0, {"i": i}), ("b", place_b, unit[0], 2.0, {"j": j})):
        spin = tuple(rng.uniform(-1, 1, 3))
        inertia = tuple(rng.uniform(0.2, 0.3, 3))
        velocity = tuple(along if name == "a" else -along)
        model.add(
            name,
            Body(
                mass=mass,
                inertia=inertia,
                position=place,
                orientation=p,
                velocity=velocity,
                omega=spin,
                markers=markers,
            ),
        )
    model.add("element", element(i="a.i", j="b.j", **fields))
    return model


def wrenches(model, t=0.37):
    """Force and torque about the origin (ground axes) that the element puts on each body, as they are drawn."""
    system = compile_model(model.data())
    state = State(system)
    state.evaluate("motion", t)
    found = []
    of_bodies = state.vector("motion", "f").reshape(-1, 6)
    for f, q, u, moments in zip(
        of_bodies,
        state.q[: 7 * len(of_bodies)].reshape(-1, 7),
        state.u.reshape(-1, 6),
        system.mass.reshape(-1, 6)[:, 3:],
        strict=True,
    ):
        gyroscopic = -np.cross(u[3:], moments * u[3:])
        found.append([f[:3], np.cross(q[:3], f[:3]) + matrix(q[3:]) @ (f[3:] - gyroscopic)])
    return np.array(found)


def momenta(model, solution):
    """Linear and angular momentum about the origin of all bodies over time, shape (2, n, 3)."""
    linear = angular = 0
    for name, body in model.bodies.items():
        r, v, w = (
            np.stack([solution[f"{name}.{letter}{axis}"] for axis in "xyz"], axis=-1) for letter in ("", "v", "w")
        )
        p = np.stack([solution[f"{name}.q{k}"] for k in range(4)], axis=-1)
        turning = np.stack([matrix(own) for own in p]) @ (w @ np.array(body.inertia))[..., None]
        linear = linear + body.mass * v
        angular = angular + body.mass * np.cross(r, v) + turning[..., 0]
    return np.array([linear, angular])
