"""Equilibria, modes, transfer functions and sensitivities do not depend on axes, place, units, names and order, nor on earlier results."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import stiffmbs
from tests.stress.invariance import naming, rigid, similarity
from tests.stress.invariance.ways import scene_of

SEEDS = st.integers(0, 2**20)
FEW = settings(max_examples=3)
FREQUENCIES = np.array([0.0, 0.5, 2.0, 30.0])


def content_of(rng, dimensions):
    """Return a closed chain of two bodies on springs and bushings, with random places, masses and stiffnesses."""

    def near(*place):
        return (np.array(place)[:dimensions] + rng.uniform(-0.1, 0.1, dimensions)).tolist()

    def at(body, *place):
        return {"body": body, "point": near(*place)}

    turns = 3 if dimensions == 3 else 1
    bodies = {
        name: {"mass": rng.uniform(1, 3), "inertia": rng.uniform(0.2, 0.3, 3).tolist() if turns == 3 else rng.uniform(0.1, 1), "position": near(x, 0.2, 0.1)}
        for name, x in (("arm", 0.5), ("block", 1.5))
    }  # fmt: skip
    link = {"i": at("arm", 0.4, 0.1, 0), "j": at("block", -0.3, -0.1, 0)}
    ends = np.array([np.add(bodies[end["body"]]["position"], end["point"]) for end in link.values()])
    pin = near(0, 0, 0)
    hinge = {
        "i": {"body": "arm", "point": np.subtract(pin, bodies["arm"]["position"]).tolist()},
        "j": {"body": "ground", "point": pin},
    }
    bushings = {
        f"bush_{name}": {
            "type": "bushing", "i": name, "j": at("ground", *place, 0),
            "stiffness": [*rng.uniform(200, 900, dimensions), *rng.uniform(20, 90, turns)],
            "damping": [*rng.uniform(1, 9, dimensions), *rng.uniform(0.1, 0.9, turns)],
        }
        for name, place in (("arm", (0.5, 0.2)), ("block", (1.5, 0.2)))
    }  # fmt: skip
    spring = {
        "type": "spring_damper",
        "i": at("arm", 0, 0.3, 0),
        "j": at("block", 0, 0.4, 0.2),
        "free_length": 0.6,
        "damping": 2.0,
    }
    return {
        **({"dimensions": 3} if dimensions == 3 else {}),
        "gravity": rng.uniform(-9, 9, dimensions).tolist(),
        "bodies": bodies,
        "joints": {
            "hinge": {"type": "spherical" if dimensions == 3 else "revolute", **hinge},
            "link": {"type": "distance", **link, "length": float(np.linalg.norm(ends[0] - ends[1]))},
        },
        "forces": {"spring": {**spring, "stiffness": rng.uniform(50, 300)}, **bushings},
        "requests": {"apart": "dm(arm, block)"},
        "run": {"duration": 0.1, "points": 3, "rtol": 1e-9, "solver": "bdf"},
    }  # fmt: skip


def placed(content, rng, angle, distance):
    dimensions = content.get("dimensions", 2)
    axis = rng.standard_normal(3) if dimensions == 3 else np.array([0.0, 0.0, 1.0])
    rotation = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()
    way = distance * rng.standard_normal(3) * (1, 1, dimensions == 3)
    return rigid.placed(content, rigid.Placing(rotation, way, dimensions), "placed")


UNITS = {"t, mm": similarity.Units(1e-3, 1e3, 1.0), "g, km, ms": similarity.Units(1e3, 1e-3, 1e3)}
CHANGES = {
    "turned": lambda content, rng: placed(content, rng, rng.uniform(-3, 3), 0.0),
    "moved": lambda content, rng: placed(content, rng, 0.0, 100.0),
    "renamed": naming.renamed,
    **{name: lambda content, rng, units=units: similarity.scaled(content, units) for name, units in UNITS.items()},
}
ONE = similarity.Units(1.0, 1.0, 1.0)


def name_in(change, section, name):
    """Return the name of an element or request in a changed scene."""
    names, nothing = change.content[section], np.zeros(1)
    return name if name in names else next(each for each in names if name in change.back({each: nothing}, nothing))


def original_and_changed(seed, dimensions, name):
    rng = np.random.default_rng(seed)
    content = content_of(rng, dimensions)
    return content, CHANGES[name](content, rng), UNITS.get(name, ONE)


def every_change(test):
    for parameters in (pytest.mark.parametrize("name", CHANGES), pytest.mark.parametrize("dimensions", [2, 3])):
        test = parameters(test)
    return FEW(given(seed=SEEDS)(test))


@pytest.mark.long
@pytest.mark.sampled(10)
@every_change
def test_equilibria_modes_and_transfer_functions(seed, dimensions, name):
    content, change, units = original_and_changed(seed, dimensions, name)
    found, other = (stiffmbs.equilibrium(scene_of(each)) for each in (content, change.content))
    back = change.back({key: np.array([value]) for key, value in other.channels.items()}, np.zeros(1))
    compared = [
        key
        for key in back
        if key.endswith((".x", ".y", ".z", ".angle", ".fx", ".fy", ".fz", ".torque")) or key == "apart"
    ]
    assert len(compared) > 10
    for key in compared:
        assert float(back[key][0]) == pytest.approx(found.channels[key], abs=1e-6), key
    modes = [
        stiffmbs.modes(scene_of(each), start_from=start.solution)
        for each, start in ((content, found), (change.content, other))
    ]
    values, others = (np.array([value for mode in each.modes for value in mode.eigenvalues]) for each in modes)
    np.testing.assert_allclose(others * units.time, values, rtol=1e-6)
    gains = [
        gain_of(scene_of(each), start.solution, block, FREQUENCIES / unit)
        for each, start, block, unit in (
            (content, found, "block", 1.0), (change.content, other, name_in(change, "bodies", "block"), units.time),
        )
    ]  # fmt: skip
    np.testing.assert_allclose(gains[1] / units.factor((-1, 0, 2)), gains[0], rtol=1e-6)


def gain_of(scene, state, body, frequencies):
    """Return the singular values of the transfer function from forces on a body to its displacements."""
    axes = "xyz"[: scene.dimensions]
    inputs, outputs = [f"{body}.f{axis}" for axis in axes], [f"{body}.{axis}" for axis in axes]
    return np.linalg.svd(
        stiffmbs.transfer(scene, inputs, outputs, start_from=state).response(frequencies), compute_uv=False
    )


@pytest.mark.long
@pytest.mark.sampled(10)
@every_change
def test_sensitivities(seed, dimensions, name):
    content, change, units = original_and_changed(seed, dimensions, name)
    found, other = (
        stiffmbs.sensitivities(scene_of(each), [f"forces.{spring}.stiffness"], f"final({apart})")
        for each, spring, apart in (
            (content, "spring", "apart"),
            (change.content, name_in(change, "forces", "spring"), name_in(change, "requests", "apart")),
        )
    )  # fmt: skip
    (slope,), (changed,) = found.to.values(), other.to.values()
    assert other.value / units.length == pytest.approx(found.value, rel=1e-7)
    assert changed / units.factor((-1, 1, 2)) == pytest.approx(slope, rel=1e-5)


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_results_do_not_depend_on_what_was_computed_before(dimensions, solver):
    content = content_of(np.random.default_rng(0), dimensions)
    scene, other = scene_of(content), scene_of(content_of(np.random.default_rng(1), dimensions))
    first = stiffmbs.run(scene, solver=solver)
    rest = stiffmbs.equilibrium(scene)
    values = [mode.eigenvalues for mode in stiffmbs.modes(scene, at=0.05, solver=solver).modes]
    slope = stiffmbs.sensitivities(scene, ["forces.spring.stiffness"], "final(apart)").to
    for each in (other, scene):
        stiffmbs.equilibrium(each)
        stiffmbs.run(each, solver="bdf", rtol=1e-4, formulation="I3")
    again = stiffmbs.run(scene, solver=solver)
    for name in first:
        np.testing.assert_array_equal(again[name], first[name], err_msg=name)
    assert stiffmbs.equilibrium(scene).channels == rest.channels
    assert [mode.eigenvalues for mode in stiffmbs.modes(scene, at=0.05, solver=solver).modes] == values
    assert stiffmbs.sensitivities(scene, ["forces.spring.stiffness"], "final(apart)").to == slope
