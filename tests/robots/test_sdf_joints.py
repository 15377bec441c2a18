"""Joints of SDFormat files: accelerations in closed form, by MuJoCo, and by the same joint written in another way."""

import itertools

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot

from .test_sdf import written

I, M = 0.3, 2.0
WORLD = '<sdf version="1.12"><world name="w"><gravity>{gravity}</gravity><model name="m">{body}</model></world></sdf>'


def link(name, pose="0 0 0 0 0 0", mass=M, moments=(I, I, I), centre="0 0 0", more=""):
    xx, yy, zz = moments
    return (
        f'<link name="{name}"><pose>{pose}</pose>{more}<inertial><pose>{centre} 0 0 0</pose><mass>{mass}</mass>'
        f"<inertia><ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz></inertia></inertial></link>"
    )


def joint(name, kind, parent, child, axis="", axis2="", more="", pose=""):
    axes = "".join(f"<{tag}>{given}</{tag}>" for tag, given in (("axis", axis), ("axis2", axis2)) if given)
    return (
        f'<joint name="{name}" type="{kind}">{pose}<parent>{parent}</parent><child>{child}</child>{axes}{more}</joint>'
    )


def started(tmp_path, body, gravity="0 0 0", changes=(), **state):
    path = written(tmp_path, WORLD.format(gravity=gravity, body=body))
    return stiffmbs.run(load_robot(path, changes, **state), duration=1e-6, output=1e-6, rtol=1e-10)


DYNAMICS = "<dynamics><damping>0.7</damping><friction>0.2</friction><spring_stiffness>5</spring_stiffness><spring_reference>0.4</spring_reference></dynamics>"


@pytest.mark.parametrize(
    ("kind", "inertia", "channel"), [("revolute", I, "wdz"), ("continuous", I, "wdz"), ("prismatic", M, "az")]
)
def test_springs_dampers_and_friction(tmp_path, kind, inertia, channel):
    body = link("b") + joint("j", kind, "world", "b", f"<xyz>0 0 1</xyz>{DYNAMICS}")
    run = started(tmp_path, body, coordinates={"j": 0.1}, rates={"j": 1.5})
    assert run[f"b.{channel}"][0] == pytest.approx((-5 * (0.1 - 0.4) - 0.7 * 1.5 - 0.2) / inertia, rel=1e-9)


@pytest.mark.parametrize("turn", ["0 0 0", "0.3 0.4 -0.5"])
def test_a_ball_joint_has_no_torque(tmp_path, turn):
    """At rest, the moment of momentum about the joint changes by the moment of the weight: (I + m c c) a = c x m g."""
    body = link("b", f"0 0 0 {turn}", centre="0.2 0.1 -0.05", moments=(0.1, 0.2, 0.25)) + joint(
        "j", "ball", "world", "b"
    )
    run = started(tmp_path, body, "1 2 -9")
    scene = load_robot(tmp_path / "robot.sdf")
    A = np.array(stiffmbs_matrix(scene.bodies["b"]))
    c, g = np.array([0.2, 0.1, -0.05]), A.T @ np.array([1, 2, -9.0])
    about = np.diag([0.1, 0.2, 0.25]) + M * (c @ c * np.eye(3) - np.outer(c, c))
    expected = A @ np.cross(np.linalg.solve(about, np.cross(c, M * g)), c)
    assert [run[f"b.a{axis}"][0] for axis in "xyz"] == pytest.approx(expected, rel=1e-9)


def stiffmbs_matrix(body):
    from .test_sdf import by_quaternion

    return by_quaternion(getattr(body, "orientation", None) or (1, 0, 0, 0))


@pytest.mark.parametrize(
    ("pitch", "advance"),
    [("<screw_thread_pitch>0.5</screw_thread_pitch>", 0.5), ("<thread_pitch>-20</thread_pitch>", np.pi / 10),
     ("<screw_thread_pitch>-0.3</screw_thread_pitch><thread_pitch>7</thread_pitch>", -0.3), ("", 1.0)],
)  # fmt: skip
def test_a_screw_advances_by_its_pitch(tmp_path, pitch, advance):
    """(I + m p^2) theta'' = -m g p - d theta' with the advance p for one radian."""
    axis = "<xyz>0 0 1</xyz><dynamics><damping>0.6</damping></dynamics>"
    body = link("b") + joint("j", "screw", "world", "b", axis, more=pitch)
    run = started(tmp_path, body, "0 0 -9", coordinates={"j": 4.0}, rates={"j": 1.2})
    p = advance / (2 * np.pi)
    turning = (-M * 9 * p - 0.6 * 1.2) / (I + M * p**2)
    assert run["b.wdz"][0] == pytest.approx(turning, rel=1e-8)
    assert run["b.az"][0] == pytest.approx(turning * p, rel=1e-8)
    assert run["b.z"][0] == pytest.approx(4 * p, abs=1e-9)
    assert run["b.vz"][0] == pytest.approx(1.2 * p, rel=1e-8)


@pytest.mark.parametrize("flipped", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("reverse", [(False, False), (True, False), (False, True), (True, True)])
def test_a_gearbox_couples_hinges_on_its_reference_body(tmp_path, flipped, reverse):
    """theta_2 = -n theta_1: a torque T at the first gives it T/(I_1 + n^2 I_2)."""
    hinges = "".join(
        joint(f"h{k}", "revolute", *(ends[::-1] if back else ends), f"<xyz>0 0 {-sign if back else sign}</xyz>{effort}", pose=f'<pose relative_to="{k}"/>')
        for k, sign, back, effort in zip("ab", flipped, reverse, ("<limit><effort>50</effort></limit>", ""), strict=True)
        for ends in [("base", k)]
    )  # fmt: skip
    gears = "<gearbox_ratio>3</gearbox_ratio><gearbox_reference_body>base</gearbox_reference_body>"
    body = (
        link("base") + joint("f", "fixed", "world", "base") + link("a", "1 0 0 0 0 0") + link("b", "0 1 0 0 0 0", moments=(I, I, 0.05)) + hinges
        + joint("g", "gearbox", "a", "b", "<xyz>0 0 1</xyz>", "<xyz>0 0 1</xyz>", gears)
    )  # fmt: skip
    run = started(tmp_path, body, changes=[("inputs.ha_input", "4")])
    expected = flipped[0] * 4 / (I + 9 * 0.05)
    assert [run[f"{name}.wdz"][0] for name in "ab"] == pytest.approx([expected, -3 * expected], rel=1e-8)


def test_mimicking_axes(tmp_path):
    """follower = multiplier (leader - reference) + offset, of the second axis of a universal joint too."""
    mimic = (
        '<mimic joint="{}" axis="{}"><multiplier>2</multiplier><offset>0.1</offset><reference>0.3</reference></mimic>'
    )
    body = (
        link("a") + link("b", "0 1 0 0 0 0") + link("c", "0 2 0 0 0 0") + joint("u", "universal", "world", "a", "<xyz>1 0 0</xyz>", "<xyz>0 1 0</xyz>")
        + joint("arm", "revolute", "world", "b", "<xyz>0 0 1</xyz>" + mimic.format("u", "axis2"))
        + joint("rod", "prismatic", "world", "c", "<xyz>0 0 1</xyz>" + mimic.format("arm", "axis"))
    )  # fmt: skip
    run = started(tmp_path, body, coordinates={"u_axis2": 0.7}, rates={"u_axis2": 1.5})
    assert run["arm.angle"][0] == pytest.approx(0.9, abs=1e-9)
    assert run["rod.displacement"][0] == pytest.approx(1.3, abs=1e-9)
    assert run["c.vz"][0] == pytest.approx(6.0, abs=1e-6)


def test_a_joint_between_equal_limits_is_held(tmp_path):
    limit = "<limit><lower>{0}</lower><upper>{0}</upper></limit>"
    body = link("a") + joint("j", "revolute", "world", "a", "<xyz>1 0 0</xyz>" + limit.format(0.2))
    run = started(
        tmp_path, body + link("b") + joint("k", "continuous", "world", "b", "<xyz>1 0 0</xyz>" + limit.format(0))
    )
    assert run["j.angle"][0] == pytest.approx(0.2, abs=1e-9)
    assert "k_held" not in load_robot(tmp_path / "robot.sdf").joints


@pytest.mark.parametrize("kind", ["universal", "revolute2"])
@pytest.mark.parametrize("seed", range(2))
def test_two_axes_are_those_of_two_hinges_of_mujoco(tmp_path, kind, seed):
    pytest.importorskip("mujoco")
    from .mujoco_oracle import by_mujoco, compiled

    rng = np.random.default_rng(seed)
    first, second = rng.normal(size=(2, 3))
    point = rng.uniform(-0.2, 0.2, 3)
    axes = [" ".join(map(repr, map(float, axis))) for axis in (first, second)]
    dynamics = "<dynamics><damping>{}</damping><spring_stiffness>3</spring_stiffness></dynamics>"
    body = link("b", "0.1 0.2 0.3 0 0 0", centre="0.2 0.1 -0.05", moments=(0.1, 0.2, 0.25)) + joint(
        "j", kind, "world", "b", f"<xyz>{axes[0]}</xyz>{dynamics.format(0.5)}", f"<xyz>{axes[1]}</xyz>{dynamics.format(0.8)}",
        pose=f"<pose>{' '.join(map(repr, map(float, point)))} 0 0 0</pose>",
    )  # fmt: skip
    place = " ".join(map(repr, map(float, point)))
    m = compiled(
        '<mujoco><option gravity="0 0 -9"/><worldbody><body name="b" pos="0.1 0.2 0.3">'
        f'<joint name="j" pos="{place}" axis="{axes[0]}" damping="0.5" stiffness="3"/><joint name="j_axis2" pos="{place}" axis="{axes[1]}" damping="0.8" stiffness="3"/>'
        '<inertial pos="0.2 0.1 -0.05" mass="2" diaginertia="0.1 0.2 0.25"/></body></worldbody></mujoco>'
    )
    values = {"j": 0.4, "j_axis2": -0.6}, {"j": 1.1, "j_axis2": 0.7}
    run = started(tmp_path, body, "0 0 -9", coordinates=values[0], rates=values[1])
    position, acceleration = by_mujoco(m, *values, [])["b"]
    assert [run[f"b.{axis}"][0] for axis in "xyz"] == pytest.approx(position, abs=1e-9)
    assert [run[f"b.a{axis}"][0] for axis in "xyz"] == pytest.approx(
        acceleration, abs=1e-6 * np.abs(acceleration).max()
    )


AXIS, AXIS2 = np.array([0.6, 0, 0.8]), np.array([0.0, 1.0, 0.0])
EXCHANGED = {"revolute": 1, "prismatic": 1, "screw": 1, "universal": 2, "revolute2": 2, "ball": 0, "fixed": 0}


def text(axis):
    return f"<xyz>{' '.join(map(repr, map(float, axis)))}</xyz><dynamics><damping>0.3</damping></dynamics>"


@pytest.mark.parametrize("kind", EXCHANGED)
def test_parent_and_child_can_be_exchanged(tmp_path, kind):
    """The angle of the child about an axis is that of the parent about the opposite one; two axes are in order."""
    bodies = (
        link("a", "0 0 1 0.2 0.3 0", centre="0.1 0.2 0") + link("b", "0.3 0.1 0.8 0 0.4 1", centre="-0.1 0 0.2")
        + joint("base", "revolute", "world", "a", "<xyz>0 1 0</xyz>")
    )  # fmt: skip
    pose = '<pose relative_to="a">0.2 0 0.1 0.3 0 0</pose>'
    count = EXCHANGED[kind]
    there = joint("j", kind, "a", "b", *[text(axis) for axis in (AXIS, AXIS2)[:count]], pose=pose)
    back = joint("j", kind, "b", "a", *[text(-axis) for axis in (AXIS, AXIS2)[:count][::-1]], pose=pose)
    names = ["j", "j_axis2"][:count]
    found = []
    for given, order in ((there, names), (back, names[::-1])):
        state = {
            "coordinates": dict(zip(order, (0.4, -0.2), strict=False)),
            "rates": dict(zip(order, (0.9, 1.3), strict=False)),
        }
        run = started(tmp_path, bodies + given, "0 0 -9", **state)
        found.append([run[f"{name}.{a}{axis}"][0] for name in "ab" for a in ("", "a") for axis in "xyz"])
    np.testing.assert_allclose(found[1], found[0], atol=1e-6 if count == 2 else 1e-9)


SPRING = "<dynamics><spring_stiffness>2</spring_stiffness><spring_reference>0.3</spring_reference></dynamics>"
LOOP = {
    "revolute": ((0, 1, 0.1),), "universal": ((1, 0, 0.3), (0, 1, 0)), "ball": (), "prismatic": ((1, 0, 0.2),), "screw": ((0.2, 0, 1),),
    "revolute2": ((1, 0, 0.3), (0, 0.6, 0.8)), "fixed": (),
}  # fmt: skip
LOOPS = [
    ("revolute", "ball", "ball", "revolute"), ("revolute", "universal", "ball", "revolute"), ("prismatic", "ball", "universal", "revolute"),
    ("revolute", "ball", "screw", "universal"), ("revolute", "revolute2", "ball", "revolute"), ("revolute", "ball", "fixed", "ball"),
]  # fmt: skip


def in_loop(name, kind, ends, point, reverse):
    sign = -1 if reverse else 1
    axes = [f"<xyz>{' '.join(str(sign * x) for x in axis)}</xyz>{SPRING}" for axis in LOOP[kind]][::sign]
    pose = f'<pose relative_to="__model__">{point} 0 0 0</pose>'
    return joint(name, kind, *ends[::sign], *axes, pose=pose)


@pytest.mark.parametrize("kinds", LOOPS)
def test_a_loop_moves_in_the_same_way_wherever_it_is_cut(tmp_path, kinds):
    """Parents and children are exchanged at random, which decides the joint that closes the loop."""
    points = ["0 0 0", "0 0.1 0.5", "0.6 0.2 0.4", "0.7 0 -0.1"]
    ends = [("world", "a"), ("a", "b"), ("b", "c"), ("world", "c")]
    body = "".join(
        link(name, f"{at} 0 0 0", centre="0.1 0 0.1", moments=(0.1, 0.2, 0.25))
        for name, at in zip("abc", ("0 0 0.2", "0.3 0.1 0.5", "0.7 0.1 0.2"), strict=True)
    )
    found = {}
    for reverse in itertools.product((False, True), repeat=2):
        given = "".join(map(in_loop, [f"j{k}" for k in range(4)], kinds, ends, points, (False, *reverse, False)))
        path = written(tmp_path, WORLD.format(gravity="0.5 1 -9", body=body + given))
        cut = "; ".join(load_robot(path).notes).partition("close loops: ")[2][:2]
        run = stiffmbs.run(load_robot(path), duration=1e-6, output=1e-6, rtol=1e-10)
        found[cut] = np.array([run[f"{name}.a{axis}"][0] for name in "abc" for axis in "xyz"])
    one, *others = found.values()
    assert others
    for other in others:
        np.testing.assert_allclose(other, one, atol=1e-5 * np.abs(one).max())


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (joint("j", "hinge", "world", "b", "<xyz>0 0 1</xyz>"), "joint j: found the type hinge, expected one of revolute"),
        (joint("j", "revolute", "world", "b"), "joint j: found no <axis>, expected one with the direction"),
        (joint("j", "universal", "world", "b", "<xyz>0 0 1</xyz>"), "joint j: found no <axis2>"),
        (joint("j", "revolute", "world", "b", "<xyz>0 0 0</xyz>"), "joint j: found an axis of length 0"),
        (joint("j", "revolute", "world", "b", "<xyz>0 0</xyz>"), "joint j: found '0 0' in <xyz>, expected 3 finite numbers"),
        (joint("j", "revolute", "world", "c", "<xyz>0 0 1</xyz>"), "joint j: found the frame c, expected a link, joint, frame or model of model m: b"),
        (joint("j", "revolute", "b", "world", "<xyz>0 0 1</xyz>"), "joint j: found the child world, expected a link: exchange"),
        (joint("j", "revolute", "b", "b", "<xyz>0 0 1</xyz>"), "joint j: found that it connects b with itself"),
        ('<joint name="j" type="fixed"><parent>b</parent></joint>', "joint j: found no <child>"),
        (joint("j", "screw", "world", "b", "<xyz>0 0 1</xyz>", more="<thread_pitch>0</thread_pitch>"), "joint j: found a <thread_pitch> of 0"),
        (joint("j", "revolute", "world", "b", "<xyz>0 0 1</xyz><limit><lower>low</lower></limit>"), "joint j: found 'low' in <lower>, expected a number"),
        (joint("j", "revolute", "world", "b", '<xyz>0 0 1</xyz><mimic joint="k"/>'), "joint j: found that it mimics axis of k, expected an axis of another"),
        (joint("j", "gearbox", "world", "b", "<xyz>0 0 1</xyz>", "<xyz>0 0 1</xyz>"), "joint j: found no <gearbox_reference_body>"),
        (joint("j", "gearbox", "world", "b", "<xyz>0 0 1</xyz>", "<xyz>0 0 1</xyz>", "<gearbox_reference_body>b</gearbox_reference_body>"), "joint j: found no hinge of the world on b about the axis"),
        (2 * joint("j", "fixed", "world", "b"), "found two joints j, expected one of each name"),
        (joint("j", "universal", "world", "b", "<xyz>0 0 1</xyz>", "<xyz>0 1 0</xyz>") + link("c") + joint("j_axis2", "revolute", "world", "c", "<xyz>0 0 1</xyz>"), "found two joints j_axis2"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_joint_is_named(tmp_path, body, message):
    with pytest.raises(InputError) as error:
        load_robot(written(tmp_path, WORLD.format(gravity="0 0 0", body=link("b") + body)))
    assert message in str(error.value)
