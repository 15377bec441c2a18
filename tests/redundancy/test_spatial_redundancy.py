"""Degrees of freedom, redundant equations, and reactions that rigid bodies do not determine, in space."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import AssemblyError
from stiffmbs.commands.main import main
from stiffmbs.elements.spatial.orientation import matrix, product
from stiffmbs.elements.spatial.spatial_kinds import JOINTS
from stiffmbs.spatial import (
    Body,
    Cylindrical,
    Drive,
    Fixed,
    Marker,
    Model,
    Planar,
    PointOnLine,
    Prismatic,
    Revolute,
    Spherical,
)

from ..spatial_loops import door, ground, parallelogram, random_turn, slider_crank, turned

FEW = settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
SEEDS = st.integers(0, 2**32 - 1)
COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")
HOLDS = {
    Revolute: "xyz xy", Prismatic: "xy xyz", Cylindrical: "xy xy", Spherical: "xyz ", Fixed: "xyz xyz", Planar: "z xy",
    PointOnLine: "xy ",
}  # fmt: skip
"""Along which axes of marker j velocities of points are held, and about which angular velocities."""
SLANTED = random_turn(np.random.default_rng(5))


def channels(joints, components):
    return {f"{joint}.{component}" for joint in joints for component in components.split()}


def rows_of(joint, model):
    """A joint's velocity rows as drawn, and what each of them exerts on the first body: 6 components, in ground axes."""
    j = model.initial_marker(joint.j)
    i = model.initial_marker(joint.i)
    rows, wrenches = [], []
    for kind, axes in enumerate(HOLDS[type(joint)].split(" ")):
        for name in axes:
            axis = getattr(j, name)
            row = {body: np.zeros(6) for body in model.bodies}
            for marker, sign in ((joint.i, 1), (joint.j, -1)):
                if marker.body in row:
                    arm = i.point - np.array(model.bodies[marker.body].position)
                    row[marker.body] += sign * np.hstack([(1 - kind) * axis, axis if kind else np.cross(arm, axis)])
            rows.append(np.hstack(list(row.values())))
            wrenches.append(np.hstack([(1 - kind) * axis, kind * axis]))
    return np.array(rows), np.array(wrenches)


def rank_and_loose(model):
    """Rank of the hand-written Jacobian as drawn, and the channels that change along the null space of its transpose."""
    data = model.data() if isinstance(model, Model) else model
    parts = {name: rows_of(joint, data) for name, joint in model.joints.items()}
    J = np.vstack([rows for rows, _ in parts.values()])
    rank = int(np.linalg.matrix_rank(J, tol=1e-9))
    free, first, loose = np.linalg.svd(J.T)[2][rank:], 0, set()
    for name, (rows, wrenches) in parts.items():
        change = np.abs(free[:, first : first + len(rows)] @ wrenches).max(axis=0, initial=0.0)
        loose |= {f"{name}.{c}" for c, much in zip(COMPONENTS, change, strict=True) if much > 1e-7}
        first += len(rows)
    return len(J), rank, loose


@pytest.mark.parametrize("turn", [(1, 0, 0, 0), SLANTED], ids=["upright", "slanted"])
def test_a_door_on_two_hinges(turn):
    model = turned(door(), turn)
    report = stiffmbs.check(model)
    assert (report.equations, report.rank, report.degrees_of_freedom) == (10, 5, 1)
    assert {joint for joint, _ in report.redundant} == {"upper"} and len(report.redundant) == 5
    held = "fx fy fz tx ty" if turn == (1, 0, 0, 0) else "fx fy fz tx ty tz"
    assert set(report.not_unique) == channels(("lower", "upper"), held) == rank_and_loose(model)[2]
    (case,) = report.overconstraints
    assert case.shared
    assert set(case.remedies) == {("lower",), ("upper",)}
    assert case.replacements == ((("upper", "spherical"), ("lower", "point_on_line")),)
    assert "lower and upper constrain the same motion of door" in report.messages[0]
    assert "a spherical joint in place of upper and a point_on_line joint in place of lower" in report.messages[2]
    assert not report.sound


def test_the_sums_over_the_hinges_are_unique_and_no_component_is():
    runs = [
        stiffmbs.run(door(), duration=0.5, points=6, rtol=1e-9, drop_first=(hinge,)) for hinge in ("upper", "lower")
    ]
    for run, alone in zip(runs, ("lower", "upper"), strict=True):
        np.testing.assert_allclose(run["lower.fz"] + run["upper.fz"], 20 * 9.81)
        np.testing.assert_allclose(run[f"{alone}.fz"], 20 * 9.81)
        overturning = run["lower.ty"] + run["upper.ty"] + 1.6 * run["upper.fx"]  # about the lower hinge
        np.testing.assert_allclose(overturning, -20 * 9.81 * 0.4, rtol=1e-9)
    assert set(runs[0].not_unique) == channels(("lower", "upper"), "fx fy fz tx ty")


@pytest.mark.parametrize(
    ("kinds", "redundancy"),
    [
        ((Spherical, Revolute), 3), ((Spherical, Spherical), 1), ((Spherical, Cylindrical), 2), ((Spherical, PointOnLine), 0),
        ((Cylindrical, Cylindrical), 4), ((Revolute, Cylindrical), 4), ((PointOnLine, Revolute), 2), ((Planar, PointOnLine), 0),
    ],
)  # fmt: skip
def test_doors_on_other_hinges(kinds, redundancy):
    report = stiffmbs.check(door(kinds=kinds))
    assert report.equations - report.rank == redundancy == len(report.redundant)
    assert report.degrees_of_freedom == 6 - report.rank == (2 if kinds == (Cylindrical, Cylindrical) else 1)
    assert report.sound == (redundancy == 0)


@pytest.mark.parametrize("size", [1e-5, 1e-3, 0.1])
def test_hinges_whose_axes_do_not_agree(size):
    slanted = (turned(door(tilt=size), SLANTED), turned(door(offset=size), SLANTED))
    for model in (door(tilt=size), door(offset=size), *slanted):
        (sentence,) = stiffmbs.check(model).inconsistencies
        assert "joint 'upper'" in sentence and "contradicts lower" in sentence
        assert 0.2 * size < float(sentence.rpartition("(by ")[2].rstrip(" mrad)")) < 1.1 * size
        with pytest.raises(AssemblyError, match=r"upper.*contradicts lower"):
            stiffmbs.run(model, duration=0.1)


def test_bricards_mechanism(examples):
    scene = stiffmbs.load_scene(examples / "bricard.yaml")
    report = stiffmbs.check(scene)
    assert (report.equations, report.rank, report.degrees_of_freedom) == (30, 29, 1)
    assert len(report.redundant) == 1
    (case,) = report.overconstraints
    hinges = {f"hinge{k}" for k in range(1, 7)}
    assert set(case.joints) == hinges
    assert {joint for ((joint, _),) in case.replacements} == hinges
    assert {joint for (joint,) in case.remedies} == hinges
    assert {name.partition(".")[0] for name in report.not_unique} == hinges
    equations, rank, loose = rank_and_loose(scene)
    assert (equations, rank) == (30, 29)
    assert loose <= set(report.not_unique)  # at the start, a pose of right angles, some are zero


def test_bricards_mechanism_at_any_pose_by_an_independent_matrix(examples):
    """Poses on the way have rank 29 too, and the same channels are loose there as the report says from the start."""
    scene = stiffmbs.load_scene(examples / "bricard.yaml")
    solution = stiffmbs.run(scene, duration=3.0, points=5, rtol=1e-10)
    for k in range(5):
        bodies = {
            name: body.model_copy(update={
                "position": tuple(float(solution[f"{name}.{c}"][k]) for c in "xyz"),
                "orientation": tuple(float(solution[f"{name}.q{c}"][k]) for c in range(4)),
            })
            for name, body in scene.bodies.items()
        }  # fmt: skip
        posed = Model()
        posed.bodies, posed.joints = bodies, scene.joints
        equations, rank, loose = rank_and_loose(posed)
        assert (equations, rank) == (30, 29)
        assert loose <= set(solution.not_unique)
    assert loose == set(solution.not_unique)


@pytest.mark.parametrize("angle", [-2.5, 0.3, math.pi / 2])
def test_a_four_bar_of_parallel_hinges(angle):
    report = stiffmbs.check(parallelogram(angle))
    assert (report.equations, report.rank, report.degrees_of_freedom) == (20, 17, 1)
    hinges = ("foot0", "head0", "foot1", "head1")
    assert set(report.not_unique) == channels(hinges, "fz tx ty")
    (case,) = report.overconstraints
    assert case.replacements == ((("head1", "spherical"), ("foot1", "cylindrical")),)
    assert all(direction.vector == (0, 0, 1) for part in case.indeterminate for direction in part.directions)
    assert any(m.startswith("rigid bodies do not determine fz, tx and ty of foot0, head0,") for m in report.messages)


def test_a_slanted_four_bar_keeps_the_direction_of_its_hinges():
    report = stiffmbs.check(turned(parallelogram(1.0), SLANTED))
    for part in report.overconstraints[0].indeterminate:
        assert len(part.channels) == 6
        (direction,) = part.directions
        assert (direction.quantity, direction.axes, direction.across) == ("force", "ground", False)
        np.testing.assert_allclose(np.abs(matrix(SLANTED)[:, 2] @ direction.vector), 1, atol=1e-8)
    assert any("only forces of foot0, head0, foot1 and head1 along (" in message for message in report.messages)


def test_a_third_crank_in_space():
    """As in the plane the forces along the cranks are undetermined, and along the hinges besides: across both unique."""
    report = stiffmbs.check(parallelogram(1.0, cranks=3))
    assert (report.equations, report.rank, report.degrees_of_freedom) == (30, 23, 1)
    (case,) = report.overconstraints
    for part in case.indeterminate:
        (direction,) = part.directions
        assert (direction.quantity, direction.axes, direction.across) == ("force", f"crank{part.element[-1]}", True)
        np.testing.assert_allclose(direction.vector, (0, 1, 0), atol=1e-8)


def test_what_is_unique_does_not_depend_on_which_joint_gives_way():
    runs = [
        stiffmbs.run(parallelogram(-1.0), duration=0.5, points=6, rtol=1e-9, drop_first=(joint,))
        for joint in ("head1", "foot0", "head0")
    ]
    largest = np.max(np.abs(runs[0]["foot0.fy"]))
    for name in runs[0]:
        if name.partition(".")[0] not in ("constraint", "energy") and name not in runs[0].not_unique:
            apart = max(np.max(np.abs(run[name] - runs[0][name])) for run in runs)
            assert apart < 1e-4 * (largest + np.max(np.abs(runs[0][name]))), name


def test_a_rod_on_two_balls_turns_about_itself():
    report = stiffmbs.check(slider_crank(0.7))
    assert (report.equations, report.rank, report.degrees_of_freedom) == (16, 16, 2)
    assert report.sound
    assert report.messages == ("rod can turn by itself between big_end and small_end, which moves no other body",)
    report = stiffmbs.check(slider_crank(0.7, cross=True))
    assert (report.rank, report.degrees_of_freedom, report.messages) == (17, 1, ())


@pytest.mark.parametrize("angle", [0.0, math.pi])
def test_a_flat_parallelogram_is_singular_too(angle):
    report = stiffmbs.check(parallelogram(angle))
    assert (report.rank, report.degrees_of_freedom, report.extra_freedoms) == (17, 1, 1)
    with pytest.raises(AssemblyError, match="singular pose"):
        stiffmbs.run(parallelogram(angle))


def driven_door(*laws):
    model = door()
    for k, law in enumerate(laws):
        model.add(f"motor{k}", Drive(joint="lower", position=law))
    return model


@pytest.mark.long
def test_two_drives_that_agree():
    report = stiffmbs.check(driven_door("5*t", "5*t"), duration=3.0)
    assert (report.equations, report.rank, report.degrees_of_freedom) == (12, 6, 0)
    assert report.inconsistencies == ()
    over_driven, guided = report.overconstraints
    assert over_driven.reason.startswith("over-driven: motor0 and motor1 prescribe the same motion of door")
    assert {name for part in over_driven.indeterminate for name in part.channels} == {
        f"motor{k}.{channel}" for k in (0, 1) for channel in ("tz", "effort")
    }
    assert set(guided.joints) == {"lower", "upper"}
    solution = stiffmbs.run(driven_door("5*t", "5*t"), duration=3.0, points=31, solver="kinematic")
    np.testing.assert_allclose(solution["door.x"], 0.4 * np.cos(5 * solution.time), atol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(
    "second", ["6*t", pytest.param("5*t - t^2", marks=pytest.mark.long), "5*t + 0.1", "5*t + 0.2*step(t, 2.5, 0, 2.6, 1)"],
    ids=["speed", "acceleration", "position", "after turns"],
)  # fmt: skip
def test_two_drives_that_disagree_are_an_error_that_names_both(second):
    model = driven_door("5*t", second)
    (sentence,) = stiffmbs.check(model, duration=3.0).inconsistencies
    assert "motor0" in sentence and "motor1" in sentence
    with pytest.raises(AssemblyError, match=r"motor1.*motor0"):
        stiffmbs.run(model, duration=3.0)


@pytest.mark.long
def test_an_over_driven_loop_tells_the_drives_from_the_hinges():
    model = parallelogram(1.0)
    model.add("motor", Drive(joint="foot0", position="1 + t"))
    assert stiffmbs.check(model, duration=1.0).degrees_of_freedom == 0
    model.add("second", Drive(joint="foot1", position="1 + t"))
    drives, hinges = stiffmbs.check(model, duration=1.0).overconstraints
    assert drives.reason.startswith("over-driven: motor and second")
    assert {part.element: part.channels for part in drives.indeterminate}["motor"] == ("motor.tz", "motor.effort")
    assert hinges.reason.endswith("overconstrain loops of coupler, crank0 and crank1 (3 redundant equations)")
    assert {name for part in hinges.indeterminate for name in part.channels} == channels(
        ("foot0", "head0", "foot1", "head1"), "fz tx ty"
    )


def random_loops(rng, bodies, joints):
    """Bodies anywhere, joined at random so that all joints hold as drawn; some joints stand twice."""
    model = Model()
    for k in range(bodies):
        place = {"position": tuple(rng.uniform(-1, 1, 3)), "orientation": random_turn(rng)}
        model.add(f"b{k}", Body(mass=1, inertia=(1, 1, 1), **place))
    for k in range(joints):
        one, two = rng.choice([*model.bodies, "ground"], 2, replace=False)
        at, turn = rng.uniform(-1, 1, 3), random_turn(rng)
        kind = list(HOLDS)[rng.integers(len(HOLDS))]
        joint = kind(i=_here(model, str(one), at, turn), j=_here(model, str(two), at, turn))
        for copy in range(1 + (rng.random() < 0.3)):
            model.add(f"joint{k}_{copy}", joint)
    return model


def _here(model, body, at, turn):
    if body == "ground":
        return ground(*at, orientation=turn)
    placed = model.bodies[body]
    back = matrix(placed.orientation).T
    w, x, y, z = placed.orientation
    return Marker(body=body, point=tuple(back @ (at - placed.position)), orientation=product((w, -x, -y, -z), turn))


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 4), st.integers(2, 6))
def test_rank_of_random_loops_and_uniqueness_by_an_independent_matrix(seed, bodies, joints):
    model = random_loops(np.random.default_rng(seed), bodies, joints)
    report = stiffmbs.check(model)
    equations, rank, loose = rank_and_loose(model)
    assert (report.equations, report.rank) == (equations, rank)
    assert report.degrees_of_freedom == 6 * bodies - rank
    assert len(report.redundant) == equations - rank
    assert set(report.not_unique) == loose


@pytest.mark.long
@FEW
@given(SEEDS, st.integers(2, 3), st.integers(2, 5))
def test_remedies_make_reactions_unique(seed, bodies, joints):
    model = random_loops(np.random.default_rng(seed), bodies, joints)
    report = stiffmbs.check(model)
    for case in report.overconstraints:
        touched = {part.element for part in case.indeterminate}
        for remedy in case.remedies:
            left = stiffmbs.check(_with(model, dict.fromkeys(remedy)))
            assert not touched & {name.split(".")[0] for name in left.not_unique}
        for choice in case.replacements:
            left = stiffmbs.check(_with(model, dict(choice)))
            assert len(left.redundant) == len(report.redundant) - len(case.redundant)
            assert left.degrees_of_freedom == report.degrees_of_freedom


def _with(model, kinds):
    """A model with some joints of other kinds, or left out."""
    other = Model()
    other.bodies = model.bodies
    for name, joint in model.joints.items():
        kind = kinds.get(name, joint.kind)
        if kind:
            other.add(name, JOINTS[kind](i=joint.i, j=joint.j))
    return other


def test_replacements_of_the_named_mechanisms_work(examples):
    bricard = stiffmbs.load_scene(examples / "bricard.yaml")
    for model in (door(), parallelogram(1.0), turned(parallelogram(1.0), SLANTED), bricard):
        (case,) = stiffmbs.check(model).overconstraints
        assert case.replacements
        for choice in case.replacements:
            report = stiffmbs.check(_with(model, dict(choice)))
            assert report.sound, (choice, report.messages)
            assert report.degrees_of_freedom == 1
            assert report.equations == report.rank


def test_check_as_json(tmp_path):
    (tmp_path / "door.yaml").write_text("""
name: A door
dimensions: 3
gravity: [0, 0, -9.81]
bodies: {door: {mass: 20, inertia: [3, 4, 1.2], position: [0.4, 0, 1]}}
joints:
  lower: {type: revolute, i: {body: door, point: [-0.4, 0, -0.8]}, j: {body: ground, point: [0, 0, 0.2]}}
  upper: {type: revolute, i: {body: door, point: [-0.4, 0, 0.8]}, j: {body: ground, point: [0, 0, 1.8]}}
run: {duration: 0.1, points: 3}
""")
    result = CliRunner().invoke(main, ["check", str(tmp_path / "door.yaml"), "--json"])
    assert result.exit_code == 1
    report = json.loads(result.output)
    assert (report["degrees_of_freedom"], report["equations"], report["rank"]) == (1, 10, 5)
    names = ("x", "y", "z", "x_across_z", "y_across_z")
    assert report["redundant"] == [{"joint": "upper", "equation": name} for name in names]
    assert set(report["not_unique"]) == channels(("lower", "upper"), "fx fy fz tx ty")
    assert report["unknowns"] == {"before": 7 + 6 + 20, "after": 7 + 6 + 10}
