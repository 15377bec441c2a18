"""Advice on what is held twice, tested by what the load does: with it, reactions follow from statics or from stiffness."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import spatial
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.redundancy.replacements import COMPONENTS

from ..spatial_loops import door, ground, parallelogram
from . import test_redundancy as plane
from . import test_spatial_redundancy as space

FEW = settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
SEEDS = st.integers(0, 2**32 - 1)
STIFF = 1e7
WEIGHT = 9.81
PLANAR = {"revolute": (1, 1, 0), "prismatic": (0, 1, 1), "fixed": (1, 1, 1)}


def elastic(model, case, stiffness, damping=2e4):
    """The model with bushings in place of the joints that the advice names, each with its own stiffness where the joint holds."""
    other = type(model)(model.name, gravity=model.gravity)
    other.bodies = model.bodies
    in_space = isinstance(model, spatial.Model)
    kind = spatial.Bushing if in_space else FORCES["bushing"]
    for name, joint in model.joints.items():
        if name not in case.elastic:
            other.add(name, joint)
            continue
        held = [c in joint.transmits for c in COMPONENTS] if in_space else PLANAR[joint.kind]
        k, c = (tuple(float(h) * value for h in held) for value in (stiffness[name], damping))
        other.add(name, kind(i=joint.i, j=joint.j, stiffness=k, damping=c))
    return other


def settled(model, **how):
    """The channels at the end of a run in which a start without deflection has come to rest."""
    solution = stiffmbs.run(model, duration=1.0, points=3, rtol=1e-7, **how)
    return {name: values[-1] for name, values in solution.items()}, solution


def shared(model, first=1.0, others=1.0, **how):
    """What the advised model carries where the first elastic joint is `first` times as stiff as the others."""
    (case,) = stiffmbs.check(model).overconstraints
    stiffness = {name: STIFF * (first if k == 0 else others) for k, name in enumerate(case.elastic)}
    at_rest, solution = settled(elastic(model, case, stiffness), **how)
    assert not set(solution.not_unique)
    return case, at_rest


@pytest.mark.long
@pytest.mark.parametrize("ratio", [1.0, 3.0, 0.2])
def test_two_hinges_of_a_door_share_its_weight_by_their_stiffness(ratio):
    case, at_rest = shared(door(), ratio)
    assert set(case.elastic) == {"lower", "upper"}
    assert "bushings in place of both lower and upper" in case.remedy
    assert "a single elastic joint parallel to rigid ones carries no load" in case.remedy
    assert at_rest["lower.fz"] == pytest.approx(20 * WEIGHT * ratio / (1 + ratio), rel=1e-3)
    assert at_rest["upper.fz"] == pytest.approx(20 * WEIGHT / (1 + ratio), rel=1e-3)


@pytest.mark.long
def test_one_elastic_hinge_carries_nothing():
    """Why one bushing is no advice: whatever its stiffness, the rigid hinge holds the door."""
    model = door()
    (case,) = stiffmbs.check(model).overconstraints
    stiffness = {"lower": STIFF, "upper": STIFF}
    only = elastic(model, case, stiffness)
    del only.forces["lower"]
    only.add("lower", model.joints["lower"])
    at_rest, _ = settled(only)
    assert abs(at_rest["upper.fz"]) < 1e-3


@pytest.mark.parametrize("ratio", [1.0, 4.0, 0.25])
def test_three_cranks_share_as_a_beam_on_three_springs(ratio):
    """The coupler hangs on three cranks at 0, 2 and 1 m; its weight pulls in the middle, where the third is."""
    model = plane.parallelogram(-math.pi / 2)
    case, at_rest = shared(model, 1.0, ratio)
    assert len(case.elastic) == 3 and {name[-1] for name in case.elastic} == {"0", "1", "2"}
    x = np.array([float(name[-1] == "1") * 2 + float(name[-1] == "2") for name in case.elastic]) - 1.0
    k = STIFF * np.array([1.0, ratio, ratio])
    A = np.array([[k.sum(), k @ x], [k @ x, k @ x**2]])
    sag, tilt = np.linalg.solve(A, [2 * WEIGHT, 0.0])
    expected = dict(zip(case.elastic, k * (sag + tilt * x), strict=True))
    for name in case.elastic:  # each head carries the coupler
        assert abs(at_rest[f"{name}.fy"]) == pytest.approx(abs(expected[name]), rel=1e-3, abs=1e-3)


@pytest.mark.parametrize("ratio", [1.0, 5.0])
def test_two_rails_share_a_weight_by_their_stiffness(ratio):
    """Both rails hold the block across, 1 m apart in height: the normal forces share as the stiffnesses do."""
    model = plane.guided_twice()
    case, at_rest = shared(model, ratio)
    assert set(case.elastic) == {"rail", "guide"}
    first, second = case.elastic
    assert at_rest[f"{first}.fy"] == pytest.approx(WEIGHT * ratio / (1 + ratio), rel=1e-3)
    assert at_rest[f"{second}.fy"] == pytest.approx(WEIGHT / (1 + ratio), rel=1e-3)


def table():
    model = spatial.Model("table", gravity=(0, 0, -9.81))
    top = model.add("top", spatial.Body(mass=10, inertia=(1, 1, 2), position=(0, 0, 1)))
    for k, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        model.add(f"leg{k}", spatial.PointOnPlane(i=top.at(x, y, -1), j=ground()))
    return model


@pytest.mark.long
@pytest.mark.parametrize("ratio", [1.0, 2.0, 0.1])
def test_a_table_on_four_legs(ratio):
    """Springs k0 and 1, 1, 1 under the corners of a plate: the diagonals share as their compliances in series do."""
    model = table()
    case, at_rest = shared(model, ratio)
    assert case.elastic == ("leg0", "leg1", "leg2", "leg3")
    x, y, k = np.array([1, -1, -1, 1]), np.array([1, 1, -1, -1]), STIFF * np.array([ratio, 1, 1, 1])
    B = np.vstack([np.ones(4), x, y])
    expected = k * (np.linalg.solve(B * k @ B.T, [10 * WEIGHT, 0, 0]) @ B)
    np.testing.assert_allclose([at_rest[f"{name}.fz"] for name in case.elastic], expected, rtol=1e-3)


@pytest.mark.parametrize("ratio", [1.0, 10.0])
def test_a_single_loop_of_parallel_hinges_needs_all_of_them_elastic(ratio):
    """A four-bar in the plane z = 0 that hangs at rest, loaded along its hinges: the loads go to both feet by stiffness."""
    model = parallelogram(-math.pi / 2)
    model.gravity = (0, -9.81, -1.0)
    (case,) = stiffmbs.check(model).overconstraints
    assert set(case.elastic) == {"foot0", "head0", "foot1", "head1"}
    stiffness = {name: STIFF * (ratio if name[-1] == "0" else 1.0) for name in case.elastic}
    at_rest, _ = settled(elastic(model, case, stiffness))
    of_feet = [at_rest["foot0.fz"], at_rest["foot1.fz"]]
    assert sum(of_feet) == pytest.approx(4.0, rel=1e-3)
    assert (of_feet[0] > 1.2 * of_feet[1]) == (ratio > 1)


def test_of_equal_drives_one_is_left_out():
    (case,) = stiffmbs.check(plane.driven_crank("crank.angle - 2*t", "crank.angle - 2*t")).overconstraints
    assert case.elastic == ()
    assert case.remedy == "without one of motor0 and motor1, all reactions are statically determinate"
    assert stiffmbs.check(plane.driven_crank("crank.angle - 2*t")).not_unique == ()


def shares(rows, elastic_rows, known, compliance):
    """Of all multipliers known + N w those of least energy: 1/2 sum c_k lam_k^2 over the elastic rows."""
    rank = int(np.linalg.matrix_rank(rows, tol=1e-9))
    N = np.linalg.svd(rows.T)[2][rank:].T
    root = np.sqrt(compliance)[:, None]
    w = np.linalg.lstsq(root * N[elastic_rows], -root[:, 0] * known[elastic_rows])[0]
    return N, known + N @ w


def decided_by_stiffness(cases, rows, rng):
    """Castigliano's split of any load, by rows of each joint: every reaction moves as the stiffnesses change."""
    names = [name for name in rows for _ in rows[name]]
    J = np.vstack(list(rows.values()))
    together = {name for case in cases for name in case.elastic}
    chosen = np.array([name in together for name in names])
    known = rng.normal(size=len(J))
    N, one = shares(J, chosen, known, rng.uniform(0.2, 5, chosen.sum()))
    _, other = shares(J, chosen, known, rng.uniform(0.2, 5, chosen.sum()))
    assert N.shape[1] == sum(len(case.redundant) for case in cases)
    for element in {part.element for case in cases for part in case.indeterminate}:
        own = [k for k, name in enumerate(names) if name == element]
        assert np.abs(one[own] - other[own]).max() > 1e-9, f"{element} does not depend on stiffness"
    for name in together:
        own = [k for k, joint in enumerate(names) if joint == name]
        assert np.abs(one[own]).max() > 1e-9, f"{name} carries nothing"


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 4), st.integers(3, 6))
def test_advice_on_random_loops_in_the_plane(seed, bodies, joints):
    rng = np.random.default_rng(seed)
    model, pose = plane.random_loops(rng, bodies, joints)
    if cases := stiffmbs.check(model).overconstraints:
        assert all(case.elastic for case in cases)
        decided_by_stiffness(cases, {name: plane.rows_of(joint, pose) for name, joint in model.joints.items()}, rng)


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 3), st.integers(2, 5))
def test_advice_on_random_loops_in_space(seed, bodies, joints):
    rng = np.random.default_rng(seed)
    model = space.random_loops(rng, bodies, joints)
    data = model.data()
    if cases := stiffmbs.check(model).overconstraints:
        assert all(case.elastic for case in cases)
        decided_by_stiffness(cases, {name: space.rows_of(joint, data)[0] for name, joint in model.joints.items()}, rng)
