"""Degrees of freedom, redundant equations, and reactions that rigid bodies do not determine."""

import itertools
import math

import numpy as np
import pytest
import sympy
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import (
    AssemblyError,
    Body,
    ConstraintEquation,
    Distance,
    Drive,
    Fixed,
    InputError,
    Marker,
    Model,
    Prismatic,
    Revolute,
)
from stiffmbs.compile.state import State
from stiffmbs.redundancy.loops import loops
from tests.stress.random_tree import random_tree

FEW = settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
SEEDS = st.integers(0, 2**32 - 1)
CRANK, SPAN = 0.5, 2.0


def ground(x, y, angle=0.0):
    return Marker(body="ground", point=(x, y), angle=angle)


def guided_twice(slope=0.0):
    """A block on two parallel rails."""
    model = Model(gravity=(0, -9.81))
    block = model.add("block", Body(mass=1, inertia=1))
    across = (-math.sin(slope), math.cos(slope))
    model.add("rail", Prismatic(i=block.at(0, 0, slope), j=ground(0, 0, slope)))
    model.add("guide", Prismatic(i=block.at(*across, slope), j=ground(*across, slope)))
    return model


def parallelogram(angle, cranks=3, size=1.0, mass=1.0, inertia=0.02):
    """A coupler on parallel cranks of equal length, crank 2 between the others."""
    model = Model(gravity=(0, -9.81))
    r, span = CRANK * size, SPAN * size
    c, s = math.cos(angle), math.sin(angle)
    coupler = model.add("coupler", Body(mass=2, inertia=size**2, position=(span / 2 + r * c, r * s)))
    for k, x in enumerate((0.0, span, span / 2)[:cranks]):
        place = (x + r / 2 * c, r / 2 * s)
        crank = model.add(f"crank{k}", Body(mass=mass, inertia=inertia * size**2, position=place, angle=angle))
        model.add(f"foot{k}", Revolute(i=crank.at(-r / 2, 0), j=ground(x, 0)))
        model.add(f"head{k}", Revolute(i=crank.at(r / 2, 0), j=coupler.at(x - span / 2, 0)))
    return model


PINS = [f"{place}{k}" for k in range(3) for place in ("foot", "head")]


def driven_crank(*laws):
    """A pinned crank with an equation for each law."""
    model = Model()
    crank = model.add("crank", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("pin", Revolute(i=crank.at(-1, 0), j="ground"))
    for k, law in enumerate(laws):
        model.add(f"motor{k}", ConstraintEquation(zero=[law]))
    return model


def open_chain_closed(points):
    """Rods along a line through given places, the ends pinned to ground: a flat linkage."""
    model = Model(gravity=(0, -9.81))
    before = ground(points[0], 0)
    for k, (a, b) in enumerate(itertools.pairwise(points)):
        rod = model.add(f"rod{k}", Body(mass=1, inertia=0.1, position=((a + b) / 2, 0)))
        model.add(f"pin{k}", Revolute(i=rod.at((a - b) / 2, 0), j=before))
        before = rod.at((b - a) / 2, 0)
    model.add("end", Revolute(i=before, j=ground(points[-1], 0)))
    return model


def ring(count):
    """A closed chain of equal rods, held at one pin."""
    model = Model(gravity=(0, -9.81))
    turn = 2 * math.pi / count
    half = math.sin(turn / 2)  # of a rod, on the unit circle
    middle = math.cos(turn / 2)
    for k in range(count):
        at = (k + 0.5) * turn
        place = (middle * math.cos(at), middle * math.sin(at))
        model.add(f"rod{k}", Body(mass=0.1, inertia=1e-4, position=place, angle=at + math.pi / 2))
        j = Marker(body=f"rod{k - 1}", point=(half, 0)) if k else ground(1, 0)
        model.add(f"pin{k}", Revolute(i=Marker(body=f"rod{k}", point=(-half, 0)), j=j))
    model.add("close", Revolute(i=Marker(body=f"rod{count - 1}", point=(half, 0)), j=ground(1, 0)))
    return model


@pytest.mark.parametrize("slope", [0.0, 0.5])
def test_a_block_on_two_rails(slope):
    report = stiffmbs.check(guided_twice(slope))
    assert (report.equations, report.rank, report.degrees_of_freedom) == (4, 2, 1)
    assert report.redundant == (("guide", "normal"), ("guide", "angle"))
    assert report.unknowns == (3 + 3 + 4 + 4, 1 + 1)
    forces = ("fy",) if slope == 0 else ("fx", "fy")
    assert report.not_unique == tuple(f"{joint}.{c}" for joint in ("rail", "guide") for c in (*forces, "torque"))
    (case,) = report.overconstraints
    assert set(case.joints) == {"rail", "guide"}
    assert set(case.remedies) == {("rail",), ("guide",)}
    for word in ("block", "rail", "guide"):
        assert word in case.reason + case.remedy
    assert not report.sound


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("angle", [-2.5, -1.0, 0.3, math.pi / 2])
def test_a_parallelogram_with_a_third_crank(angle, size):
    """The forces along the cranks are undetermined, those across them unique."""
    report = stiffmbs.check(parallelogram(angle, size=size))
    assert (report.equations, report.rank, report.degrees_of_freedom) == (12, 11, 1)
    assert len(report.redundant) == 1
    assert set(report.not_unique) == {f"{pin}.{c}" for pin in PINS for c in ("fx", "fy")}
    for part in report.overconstraints[0].indeterminate:
        (direction,) = part.directions
        assert direction.axes == f"crank{part.element[-1]}"
        np.testing.assert_allclose(direction.vector, (1, 0), atol=1e-6)
    assert stiffmbs.check(parallelogram(angle, cranks=2, size=size)).sound


def with_a_crank_longer_by(much):
    model = parallelogram(-1.0)
    head = model.joints["head1"]
    model.joints["head1"] = Revolute(i=Marker(body="crank1", point=(CRANK / 2 + much, 0)), j=head.j)
    return model


@pytest.mark.parametrize("much", [1e-12, 1e-9, 1e-7])
def test_equal_lengths_are_equal_to_some_digits(much):
    """What is left out stays open by the difference, and that is told."""
    report = stiffmbs.check(with_a_crank_longer_by(much))
    assert (report.rank, report.degrees_of_freedom, report.inconsistencies) == (11, 1, ())
    solution = stiffmbs.run(with_a_crank_longer_by(much), duration=1.0, points=11)
    assert 0.1 * much < solution["constraint.position"].max() < 2 * much
    assert any("agree only to" in note for note in solution.notes) == (much > 1e-11)


@pytest.mark.parametrize("much", [1e-5, 1e-3])
def test_lengths_that_differ_contradict_each_other(much):
    (sentence,) = stiffmbs.check(with_a_crank_longer_by(much)).inconsistencies
    assert "joint 'head2'" in sentence
    assert 0.1 * much < float(sentence.rpartition("(by ")[2].removesuffix(" m)")) < much
    with pytest.raises(AssemblyError, match=r"head2.*contradicts"):
        stiffmbs.run(with_a_crank_longer_by(much), duration=0.1)


def test_rank_of_the_parallelogram_in_rational_numbers():
    """At cos, sin = 4/5, 3/5 the Jacobian is rational, and its rank exact."""
    half, c, s = sympy.Rational(1, 4), sympy.Rational(4, 5), sympy.Rational(3, 5)
    rows = []
    for k, x in enumerate((-1, 1, 0)):
        for end, column in ((-1, None), (1, 0)):
            for axis, arm in ((0, -s), (1, c)):
                row = [0] * 12
                row[3 * (k + 1) + axis], row[3 * (k + 1) + 2] = 1, end * half * arm
                if column is not None:
                    row[axis], row[2] = -1, -(x if axis else 0)
                rows.append(row)
    report = stiffmbs.check(parallelogram(math.atan2(3, 4)))
    assert report.rank == sympy.Matrix(rows).rank()


@pytest.mark.parametrize("start", [-1.0, -0.3])
def test_the_third_crank_does_not_change_the_motion(start):
    """Two cranks with half as much mass more move as three; forces across the cranks are shared by mass."""
    three = stiffmbs.run(parallelogram(start), duration=2.0, points=101, rtol=1e-9)
    two = stiffmbs.run(parallelogram(start, 2, mass=1.5, inertia=0.03), duration=2.0, points=101, rtol=1e-9)
    assert three.outcome.name == "DONE"
    np.testing.assert_allclose(three["crank0.angle"], two["crank0.angle"], atol=1e-6)
    assert three.energy_drift() < 1e-5
    angle = three["crank0.angle"]
    across = [-np.sin(angle) * s["foot0.fx"] + np.cos(angle) * s["foot0.fy"] for s in (three, two)]
    np.testing.assert_allclose(across[0], across[1] / 1.5, atol=1e-4)


def test_what_is_unique_does_not_depend_on_which_joint_gives_way():
    runs = [
        stiffmbs.run(parallelogram(-1.0), duration=0.5, points=11, rtol=1e-9, drop_first=(joint,))
        for joint in ("head2", "foot0", "head1")
    ]
    for name in runs[0]:
        apart = max(np.max(np.abs(run[name] - runs[0][name])) for run in runs)
        if name in runs[0].not_unique:
            assert apart > 1e-2, name
        elif name.partition(".")[0] not in ("constraint", "energy"):
            assert apart < 1e-4 * (1 + np.max(np.abs(runs[0][name]))), name
    angle = runs[0]["crank1.angle"]
    across = [-np.sin(angle) * run["foot1.fx"] + np.cos(angle) * run["foot1.fy"] for run in runs]
    np.testing.assert_allclose(across[1], across[0], atol=1e-4)
    np.testing.assert_allclose(across[2], across[0], atol=1e-4)


def test_the_user_chooses_which_joint_gives_way():
    model = guided_twice()
    assert {joint for joint, _ in stiffmbs.check(model, drop_first=("rail",)).redundant} == {"rail"}
    assert {joint for joint, _ in model.check().redundant} == {"guide"}
    with pytest.raises(InputError, match=r"drop_first.*'rial'.*rail, guide"):
        stiffmbs.run(model, drop_first=("rial",))


@pytest.mark.parametrize("second", ["crank.angle - 2*t", "3*crank.angle - 6*t"])
def test_two_drives_that_agree(second):
    model = driven_crank("crank.angle - 2*t", second)
    report = stiffmbs.check(model)
    assert (report.equations, report.rank, report.degrees_of_freedom) == (4, 3, 0)
    assert report.redundant == (("motor1", "zero[0]"),)
    assert report.not_unique == ("motor0.torque", "motor1.torque")
    assert report.inconsistencies == ()
    assert any("0 degrees of freedom" in message for message in report.messages)
    solution = stiffmbs.run(model, duration=1.0, points=11)
    np.testing.assert_allclose(solution["crank.angle"], 2 * solution.time, atol=1e-6)
    assert "pin.fx" not in solution.not_unique


@pytest.mark.parametrize(
    "second",
    ["crank.angle - 3*t", "crank.angle - 2*t - t^2", "crank.angle - 2*t - 0.1", "crank.angle - 2*t - step(t, 0.5, 0, 0.6, 1)"],
    ids=["speed", "acceleration", "position", "later"],
)  # fmt: skip
def test_two_drives_that_disagree_are_an_error_that_names_both(second):
    model = driven_crank("crank.angle - 2*t", second)
    report = stiffmbs.check(model, duration=1.0)
    (sentence,) = report.inconsistencies
    assert "motor0" in sentence and "motor1" in sentence
    assert not report.sound
    with pytest.raises(AssemblyError, match=r"motor1.*motor0"):
        stiffmbs.run(model, duration=1.0)


@pytest.mark.long
def test_a_drive_and_a_redundant_loop_do_not_disagree():
    """Turning through many poses of an over-constrained loop is no contradiction."""
    model = parallelogram(1.0)
    model.add("motor", Drive(joint="foot0", position="1 + 6*t"))
    report = stiffmbs.check(model, duration=2.0)
    assert report.inconsistencies == ()
    assert report.degrees_of_freedom == 0
    model.add("second", Drive(joint="foot1", position="1 + 6*t"))
    assert stiffmbs.check(model, duration=2.0).inconsistencies == ()
    solution = stiffmbs.run(model, duration=2.0, points=11, solver="kinematic")
    np.testing.assert_allclose(solution["crank2.angle"], 1 + 6 * solution.time, atol=1e-9)


@pytest.mark.parametrize(
    ("model", "freedoms"),
    [(parallelogram(0.0, cranks=2), 1), (open_chain_closed((0, 1, 3, 4)), 1), (open_chain_closed((0, -1, 1.5, 0.5)), 1)],
    ids=["parallelogram", "stretched", "folded"],
)  # fmt: skip
def test_a_flat_four_bar_is_singular_not_redundant(model, freedoms):
    report = stiffmbs.check(model)
    assert (report.equations, report.rank, report.degrees_of_freedom) == (8, 8, freedoms)
    assert report.redundant == report.not_unique == ()
    assert report.extra_freedoms == 1
    assert not report.sound
    with pytest.raises(AssemblyError, match=r"singular pose"):
        stiffmbs.run(model)


def test_a_flat_pose_of_a_redundant_mechanism_is_both():
    report = stiffmbs.check(parallelogram(0.0))
    assert (report.rank, report.degrees_of_freedom, report.extra_freedoms) == (11, 1, 1)


def test_a_pose_beside_a_singular_one_is_sound():
    assert stiffmbs.check(parallelogram(0.02, cranks=2)).sound


@FEW
@given(SEEDS, st.integers(1, 8), st.booleans())
def test_a_tree_is_never_redundant_and_has_no_loops(seed, count, grounded):
    model = random_tree(np.random.default_rng(seed), count, gravity=True, grounded=grounded, springs=0)
    system = stiffmbs.compile_model(model.data())
    state = State(system)
    state.evaluate("motion", 0.0)
    assert loops(system, state) == []
    report = stiffmbs.check(model)
    assert report.sound
    assert report.degrees_of_freedom == system.n_u - system.n_c


def rows_of(joint, pose):
    """A joint's velocity rows at a pose, from rigid body velocities."""

    def place(marker):
        x, y, angle = pose.get(marker.body, (0.0, 0.0, 0.0))
        c, s = math.cos(angle), math.sin(angle)
        xi, eta = marker.point
        return np.array([x + c * xi - s * eta, y + s * xi + c * eta])

    def point_rows(marker, at):
        rows = {name: np.zeros((2, 3)) for name in pose}
        if marker.body in pose:
            arm = at - np.array(pose[marker.body][:2])
            rows[marker.body] = np.array([[1, 0, -arm[1]], [0, 1, arm[0]]])
        return np.hstack(list(rows.values()))

    at = place(joint.i)
    apart = point_rows(joint.i, at) - point_rows(joint.j, at)
    turning = np.hstack([[0, 0, float(name == joint.i.body) - float(name == joint.j.body)] for name in pose])
    if isinstance(joint, Revolute):
        return apart
    if isinstance(joint, Fixed):
        return np.vstack([apart, turning])
    angle = joint.j.angle + pose.get(joint.j.body, (0, 0, 0.0))[2]
    return np.vstack([np.array([-math.sin(angle), math.cos(angle)]) @ apart, turning])


def random_loops(rng, bodies, joints):
    """Bodies anywhere, joined at random so that all joints hold as drawn; some joints stand twice."""
    model, pose = Model(), {}
    for k in range(bodies):
        x, y, angle = rng.uniform(-1, 1, 3)
        pose[f"b{k}"] = (x, y, angle)
        model.add(f"b{k}", Body(mass=1, inertia=1, position=(x, y), angle=angle))
    for k in range(joints):
        one, two = rng.choice([*pose, "ground"], 2, replace=False)
        at, direction = rng.uniform(-1, 1, 2), rng.uniform(-3, 3)
        kind = (Revolute, Revolute, Prismatic, Fixed)[rng.integers(4)]
        joint = kind(i=_here(one, at, direction, pose), j=_here(two, at, direction, pose))
        for copy in range(1 + (rng.random() < 0.3)):
            model.add(f"joint{k}_{copy}", joint)
    return model, pose


def _here(body, at, direction, pose):
    x, y, angle = pose.get(str(body), (0.0, 0.0, 0.0))
    c, s = math.cos(angle), math.sin(angle)
    dx, dy = at - (x, y)
    return Marker(body=str(body), point=(c * dx + s * dy, -s * dx + c * dy), angle=direction - angle)


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 5), st.integers(2, 7))
def test_rank_of_random_loops_and_uniqueness_by_an_independent_matrix(seed, bodies, joints):
    model, pose = random_loops(np.random.default_rng(seed), bodies, joints)
    J = np.vstack([rows_of(joint, pose) for joint in model.joints.values()])
    names = [name for name, joint in model.joints.items() for _ in rows_of(joint, pose)]
    rank = np.linalg.matrix_rank(J, tol=1e-9)
    report = stiffmbs.check(model)
    assert (report.equations, report.rank) == (len(J), rank)
    assert report.degrees_of_freedom == 3 * bodies - rank
    assert len(report.redundant) == len(J) - rank
    free = np.linalg.svd(J.T)[2][rank:]
    loose = {name for name, column in zip(names, np.abs(free).max(axis=0, initial=0.0), strict=True) if column > 1e-7}
    assert {channel.partition(".")[0] for channel in report.not_unique} == loose


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 4), st.integers(2, 6))
def test_remedies_make_reactions_unique(seed, bodies, joints):
    model, _ = random_loops(np.random.default_rng(seed), bodies, joints)
    for case in stiffmbs.check(model).overconstraints:
        for remedy in case.remedies:
            kept = Model()
            kept.bodies = model.bodies
            kept.joints = {name: joint for name, joint in model.joints.items() if name not in remedy}
            left = stiffmbs.check(kept)
            assert not {name for part in case.indeterminate for name in part.channels} & set(left.not_unique)


def test_a_long_closed_chain_and_a_doubled_pin_in_a_shorter_one():
    assert stiffmbs.check(ring(300)).degrees_of_freedom == 3 * 300 - 2 * 301
    model = ring(40)
    again = model.joints["pin20"]
    model.add("again", Revolute(i=again.i, j=again.j))
    report = stiffmbs.check(model)
    assert report.redundant == (("again", "x"), ("again", "y"))
    assert report.not_unique == ("pin20.fx", "pin20.fy", "again.fx", "again.fy")


def test_friction_on_a_reaction_that_is_not_unique_is_told():
    model = guided_twice()
    model.add("rub", stiffmbs.JointFriction(joint="guide", friction=0.2))
    assert any("friction" in message and "not unique" in message for message in model.check().messages)


def test_bodies_connected_to_nothing_are_told():
    model = guided_twice()
    model.add("stone", Body(mass=1, inertia=1))
    assert any("stone" in message and "not connected" in message for message in model.check().messages)


def test_what_cannot_be_assembled_is_a_problem():
    model = driven_crank()
    model.add("far", Revolute(i=Marker(body="crank", point=(1, 0)), j=ground(9, 0)))
    report = model.check()
    assert not report.sound
    assert any("assembled" in message for message in report.messages)


def test_the_sum_of_what_is_not_unique_carries_the_weight():
    solution = stiffmbs.run(guided_twice(), duration=0.1, points=3)
    np.testing.assert_allclose(solution["rail.fy"] + solution["guide.fy"], 9.81)


def test_a_gap_is_no_singular_pose():
    """A rod of 1 m to a point that is 5 m away: the nearest pose is stretched, which is not what is wrong."""
    model = Model(gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5, 0)))
    model.add("hinge", Revolute(i=bar.at(-0.5, 0), j="ground"))
    model.add("strut", Distance(i=bar.at(0.5, 0), j=Marker(body="ground", point=(5, 0)), length=1.0))
    with pytest.raises(AssemblyError, match=r"the largest gap is in joint 'strut'"):
        stiffmbs.run(model, duration=0.1)
