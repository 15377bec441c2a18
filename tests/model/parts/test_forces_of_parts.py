"""Forces of shipped parts anywhere on a moving body, mirrored or not, against their formulas in NumPy."""

import json

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator
from scipy.spatial.transform import Rotation

import stiffmbs


def skew(p):
    x, y, z = p
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def turned(angles):
    return Rotation.from_euler("ZYX", angles).as_matrix(), {"euler": "zyx", "angles": angles.tolist()}


def placed(part, rng, mirror, **entry):
    """Return the use of a part at random, and its origin and axes (columns) on the body that carries it."""
    origin, (axes, orientation) = rng.uniform(-1, 1, 3), turned(rng.uniform(-1, 1, 3))
    use = {"use": part, "position": origin.tolist(), "orientation": orientation, **entry, **({"mirror": "y"} if mirror else {})}  # fmt: skip
    return use, origin, axes @ np.diag([1, -1 if mirror else 1, 1])


def scene(body, part, **sections):
    return stiffmbs.read_scene(json.dumps({"dimensions": 3, "gravity": [0, 0, 0], "bodies": {"b": body}, "parts": {"p": part}, **sections}))  # fmt: skip


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("part", ["viscoelastic_bushing", "hydromount"])
def test_the_dynamic_stiffness_of_a_mount(part, mirror):
    """The response of a free body on it, whose origin, axes and centre of mass are those of no marker."""
    rng = np.random.default_rng([len(part), mirror])
    use, origin, axes = placed(part, rng, mirror, mounts={"other" if part == "viscoelastic_bushing" else "load": "b"})
    (own, orientation), position, centre = turned(rng.uniform(-1, 1, 3)), rng.uniform(-1, 1, 3), rng.uniform(-0.3, 0.3, 3)  # fmt: skip
    mass, inertia = rng.uniform(5, 50), rng.uniform(1, 1.5, 3)
    body = {"mass": mass, "inertia": inertia.tolist(), "position": position.tolist(), "orientation": orientation, "center_of_mass": centre.tolist()}  # fmt: skip
    held = {"type": "bushing", "i": "b", "j": {"body": "ground", "point": position.tolist(), "orientation": orientation}, "stiffness": [0, 0, 0, 1e3, 1e3, 1e3]}  # fmt: skip
    found = stiffmbs.transfer(scene(body, use, forces={"held": held}), [f"b.f{a}" for a in "xyz"], [f"b.{a}" for a in "xyz"])  # fmt: skip
    arm = np.hstack([np.eye(3), -skew(origin - position - own @ centre)])
    turn = np.hstack([np.zeros((3, 3)), np.eye(3)])
    for s in (3j, 50j, 400j):
        fluid = s**2 * 40 + s * 1200
        if part == "viscoelastic_bushing":
            k = np.array([2e6, 2e6, 5e5]) + np.array([1e6, 1e6, 2.5e5]) * 0.01 * s / (1 + 0.01 * s)
            about = np.array([1000, 1000, 100]) + s
        else:
            k, about = np.array([150e3, 150e3, 200e3 + 150e3 * fluid / (150e3 + fluid)]) + 100 * s, np.zeros(3)
        stiffness = arm.T @ (axes * k) @ axes.T @ arm + turn.T @ ((axes * about) @ axes.T + 1e3 * np.eye(3)) @ turn
        inertias = np.block([[mass * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), (own * inertia) @ own.T]])
        expected = np.linalg.inv(stiffness + s**2 * inertias)[:3, :3]
        response = found.c @ np.linalg.solve(s * np.eye(len(found.a)) - found.a, found.b) + found.d
        assert np.max(np.abs(response - expected)) < 1e-9 * np.max(np.abs(expected))


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_the_force_of_the_air(seed, mirror):
    rng = np.random.default_rng([seed, mirror])
    names = ("drag_area", "side_area", "lift_area", "density")
    drag, side, lift, density = values = rng.uniform([0.3, 1, -1, 1], [1, 3, 1, 1.3])
    use, origin, axes = placed("aerodynamics", rng, mirror, on="b", parameters=dict(zip(names, values.tolist(), strict=True)))  # fmt: skip
    own, orientation = turned(rng.uniform(-1, 1, 3))
    v, w = rng.uniform(-30, 30, 3), rng.uniform(-1, 1, 3)
    body = {"mass": 1e3, "inertia": [500] * 3, "orientation": orientation, "velocity": v.tolist(), "omega": w.tolist()}
    run = stiffmbs.run(scene(body, use), duration=1e-4, output=1e-4)
    x, y, _ = speed = (own @ axes).T @ (v + own @ np.cross(w, origin))
    expected = own @ axes @ (density / 2 * np.array([-drag * np.linalg.norm(speed) * x, -side * np.linalg.norm(speed) * y, lift * x**2]))  # fmt: skip
    assert np.array([run[f"p.air.f{a}"][0] for a in "xyz"]) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("part", ["air_spring", "strut"])
def test_the_force_along_a_spring(part, mirror):
    """Along a motion through the stops of a strut, whose laws are Akima's cubics through their points."""
    rng = np.random.default_rng([len(part), mirror])
    seat, tower = rng.uniform(-0.2, 0.2, 3), np.array([0, 0, 0.5]) + rng.uniform(-0.2, 0.2, 3)
    v, flip = np.array([0, 0, -1.5]) + rng.uniform(-0.3, 0.3, 3), np.array([1, -1 if mirror else 1, 1])
    numbers = {"load": 8e3, "area": 0.03, "volume": 0.01, "exponent": 1.3, "ambient": 9e4, "damping": 900} if part == "air_spring" else {
        "load": 4e3, "stiffness": 25e3, "compression": 1200, "rebound": 2100, "digression": 0.3, "bump_travel": 0.04, "rebound_travel": 0.05,
        "bump_stiffness": 1.2e5, "rebound_stiffness": 2e5}  # fmt: skip
    entry = {"mounts": {"above": "b"}, "parameters": {**numbers, "seat": seat.tolist(), "tower": tower.tolist()}}
    use = {"use": part, **entry, **({"mirror": "y"} if mirror else {}), **({"compliance": "rigid"} if part == "strut" else {})}  # fmt: skip
    body = {"mass": 1e3, "inertia": [500] * 3, "position": (flip * tower).tolist(), "velocity": v.tolist()}
    run = stiffmbs.run(scene(body, use), duration=0.07, output=1e-3, rtol=1e-9)
    x, u = (np.stack([run[f"b.{kind}{a}"] for a in "xyz"], axis=1) for kind in ("", "v"))
    way = x - flip * seat
    length = np.linalg.norm(way, axis=1)
    s, rate = length - np.linalg.norm(tower - seat), np.sum(way * u, axis=1) / length
    if part == "air_spring":
        gas = numbers["ambient"] * 0.03
        push = (8e3 + gas) * (0.01 / (0.01 + 0.03 * s)) ** 1.3 - gas - 900 * rate
    else:
        stops = [(-0.1, -1.2e5 * 0.0525), (-0.07, -1.2e5 * 0.0225), (-0.055, -1.2e5 * 0.0075), (-0.04, 0), (-0.02, 0), (0, 0), (0.025, 0),
                 (0.05, 0), (0.06, 2e5 * 0.005), (0.07, 2e5 * 0.015), (0.09, 2e5 * 0.035)]  # fmt: skip
        digressive = lambda w: min(w, 0.2) + 0.3 * max(w - 0.2, 0)  # noqa: E731
        rates = [0.1, 0.2, 0.4, 1, 2]
        law = [(-w, -1200 * digressive(w)) for w in rates[::-1]] + [(0, 0)] + [(w, 2100 * digressive(w)) for w in rates]
        spring, damper = (Akima1DInterpolator(*np.array(points).T) for points in (stops, law))
        assert -0.1 < s.min() < -0.04 and np.ptp(rate) > 0.3
        push = 4e3 - 25e3 * s - spring(s) - damper(rate)
    force = np.stack([run[f"p.{'bellows' if part == 'air_spring' else 'strut'}.f{a}"] for a in "xyz"], axis=1)
    assert force == pytest.approx(-push[:, None] * way / length[:, None], rel=1e-9, abs=1e-6)
