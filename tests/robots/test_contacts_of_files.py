"""Contacts of SDF and URDF files, and notes on contacts of all formats."""

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.robots.load import load_robot
from stiffmbs.robots.sdf.read import read_sdf

G = 9.8
INERTIA = "<inertial><mass>2</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>"
SPHERE = "<geometry><sphere><radius>0.1</radius></sphere></geometry>"
FLOOR = """<model name="floor"><static>true</static><pose>{pose}</pose><link name="l"><collision name="c"><geometry><plane>
<normal>{normal}</normal><size>10 10</size></plane></geometry>{surface}</collision></link></model>"""
BALL = """<model name="ball"><pose>{pose}</pose><link name="body">{inertia}<collision name="c">{shape}{surface}</collision></link></model>"""


def surface(kp=None, kd=0, mu=1.0, bits=None):
    soft = "" if kp is None else f"<ode><kp>{kp}</kp><kd>{kd}</kd></ode>"
    masked = "" if bits is None else f"<collide_bitmask>{bits}</collide_bitmask>"
    return f"<surface><contact>{soft}{masked}</contact><friction><ode><mu>{mu}</mu></ode></friction></surface>"


def world(tmp_path, *models):
    path = tmp_path / "w.sdf"
    path.write_text(f'<sdf version="1.9"><world name="w">{"".join(models)}</world></sdf>')
    return path


def floor(pose="0 0 0 0 0 0", normal="0 0 1", surface=""):
    return FLOOR.format(pose=pose, normal=normal, surface=surface)


def ball(pose="0 0 0.11 0 0 0", shape=SPHERE, surface=""):
    return BALL.format(pose=pose, shape=shape, surface=surface, inertia=INERTIA)


@pytest.mark.parametrize(("kp", "other"), [(2e4, None), (2e4, 6e4)])
def test_springs_of_both_surfaces_are_in_series(tmp_path, kp, other):
    """The ball rebounds with at most 1/e^2 of its speed: the small damping is that of a simulator with steps."""
    path = world(tmp_path, floor(surface=surface(other)), ball(surface=surface(kp, kd=1)))
    found = stiffmbs.run(load_robot(path, contacts=True), duration=1.0, rtol=1e-8)
    k = kp if other is None else 1 / (1 / kp + 1 / other)
    assert 0.1 - found["ball__body.z"][-1] == pytest.approx(2 * G / k, rel=1e-5)
    assert found["ball__body.vz"].max() < np.sqrt(2 * G * 0.01) / np.e**2


def test_a_damping_above_the_critical_one_is_used(tmp_path):
    path = world(tmp_path, floor(), ball("0 0 0.1 0 0 0", surface=surface(1e6, kd=2e4)))
    scene = load_robot(path, [("bodies.ball__body.velocity", "[0, 0, -1]"), ("gravity", "[0, 0, 0]")], contacts=True)
    found = stiffmbs.run(scene, duration=2e-3, output=1e-5, rtol=1e-8)
    slow = np.roots([2.0, 2e4, 1e6])
    depth = np.diff(np.exp(np.outer(found.time, slow)), axis=1)[:, 0] / np.diff(slow)
    np.testing.assert_allclose(0.1 - found["ball__body.z"], depth, atol=8e-6)
    assert depth.max() > 9e-5


@pytest.mark.parametrize(("own", "other"), [(0.2, 0.7), (0.7, 0.2)])
def test_the_smaller_friction_counts(tmp_path, own, other):
    box = "<geometry><box><size>0.6 0.6 0.04</size></box></geometry>"
    depth = 2 * G * 1e-5 / 4
    pose = f"0 0 {0.02 - depth} 0 0 0"
    path = world(
        tmp_path, floor(surface=surface(mu=other)), ball(pose, box, surface(1e5, mu=own)),
    )  # fmt: skip
    scene = load_robot(path, [("bodies.ball__body.velocity", "[2, 0, 0]")], contacts=True)
    found = stiffmbs.run(scene, duration=1.5, rtol=1e-7)
    assert found["ball__body.x"][-1] == pytest.approx(2.0**2 / (2 * 0.2 * G), rel=3e-3)


def test_a_plane_by_its_pose_and_normal(tmp_path):
    """A ball without friction slides down with g sin(30 deg)."""
    path = world(
        tmp_path, floor("1 0 2 0 0 1", "0.5 0 0.8660254037844386", surface(mu=0)),
        ball(f"{1 + 0.05 * np.cos(1)} {0.05 * np.sin(1)} {2 + 0.05 * np.sqrt(3)} 0 0 0"),
    )  # fmt: skip
    found = stiffmbs.run(load_robot(path, contacts=True), duration=0.5, rtol=1e-8)
    speed = G * 0.5 * 0.5
    expected = speed * np.array([np.cos(1) * np.sqrt(3) / 2, np.sin(1) * np.sqrt(3) / 2, -0.5])
    assert [found[f"ball__body.v{axis}"][-1] for axis in "xyz"] == pytest.approx(expected, abs=2e-3 * speed)


LINKS = """<model name="pair">{flag}<link name="a">{inertia}<collision name="c">{sphere}{bits_a}</collision></link>
<link name="b">{inertia}<collision name="c">{sphere}{bits_b}</collision></link>{joint}</model>"""
JOINT = '<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>'
SELF = "<self_collide>true</self_collide>"


@pytest.mark.parametrize(
    ("flag", "bits", "joint", "touching"),
    [
        ("", (1, 1), "", {"a-other", "b-other"}),
        (SELF, (1, 1), "", {"a-b", "a-other", "b-other"}),
        (SELF, (1, 1), JOINT, {"a-other", "b-other"}),
        (SELF, (1, "0x2"), "", {"a-other"}),
        (SELF, (2, 2), "", {"a-b"}),
    ],
)
def test_pairs_that_touch(tmp_path, flag, bits, joint, touching):
    """Links of different models by their bits; those of one model by self_collide, unless a joint connects them."""
    text = LINKS.format(
        flag=flag,
        inertia=INERTIA,
        sphere=SPHERE,
        joint=joint,
        bits_a=surface(bits=bits[0]),
        bits_b=surface(bits=bits[1]),
    )
    other = f'<model name="m"><link name="other">{INERTIA}<collision name="c">{SPHERE}{surface(bits=1)}</collision></link></model>'
    path = world(tmp_path, text, other)
    found = {
        "-".join(shape.link.rpartition("::")[2] for shape in (each.first, each.second))
        for each in read_sdf(path, contacts=True).contacts
    }
    assert found == touching


@pytest.mark.parametrize("by", ["include", "option"])
def test_the_ground_plane_of_gazebo_needs_no_file(tmp_path, by):
    scenery = "<include><uri>model://ground_plane</uri></include>" if by == "include" else ""
    path = world(tmp_path, scenery, ball(), ball("1 0 1 0 0 0").replace('"ball"', '"other"'))
    how = {"contacts": True} if by == "include" else {"ground": 0.0}
    scene = load_robot(path, **how)
    assert not any("scenery" in note for note in scene.notes)
    found = stiffmbs.run(scene, duration=1.0)
    assert found["ball__body.z"][-1] == pytest.approx(0.1 - G * 0.05 * 0.02**2, rel=1e-5)
    assert not load_robot(path).forces


ROBOT = """<robot name="r"><link name="world"/>
<link name="base"><inertial><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><sphere radius="1"/></geometry></visual>{collision}</link>
<joint name="float" type="floating"><parent link="world"/><child link="base"/><origin xyz="0 0 0.5"/></joint>{extra}</robot>"""


def robot(tmp_path, collision, extra=""):
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT.format(collision=collision, extra=extra))
    return path


URDF_SHAPES = {
    "sphere": ('<sphere radius="0.1"/>', 0.1, 1),
    "box": ('<box size="0.1 0.2 0.12"/>', 0.06, 4),
    "cylinder": ('<cylinder radius="0.05" length="0.2"/>', 0.1, 1),
    "capsule": ('<capsule radius="0.05" length="0.2"/>', 0.15, 1),
}


@pytest.mark.parametrize("shape", URDF_SHAPES)
def test_shapes_of_urdf_rest_on_a_stated_ground(tmp_path, shape):
    text, height, points = URDF_SHAPES[shape]
    path = robot(tmp_path, f'<collision><origin xyz="0 0 0.03"/><geometry>{text}</geometry></collision>')
    found = stiffmbs.run(load_robot(path, ground=0.25), duration=1.0)
    depth = 9.81 * 0.05 * 0.02**2 / points
    assert found["base.z"][-1] == pytest.approx(0.25 - 0.03 + height - depth, abs=1e-6)


FOOT = """<link name="foot"><collision name="toe"><geometry><sphere radius="0.1"/></geometry></collision></link>
<joint name="ankle" type="{kind}"><parent link="base"/><child link="foot"/><origin xyz="0 0 -0.2"/><axis xyz="0 1 0"/></joint>"""


@pytest.mark.parametrize("kind", ["fixed", "continuous"])
def test_a_foot_without_mass_carries_its_link(tmp_path, kind):
    """Its joint moves no mass. The contact has the effective mass of the link at the foot, the mean over three directions."""
    found = load_robot(robot(tmp_path, "", FOOT.format(kind=kind)), ground=0.0)
    (contact,) = found.forces.values()
    assert contact.i.body == "base"
    mobility = (3 / 2 + 2 * 0.2**2 / 0.01) / 3
    assert contact.stiffness == pytest.approx(1 / mobility / (0.05 * 0.02**2))


def test_links_that_are_fixed_to_ground_have_no_contact(tmp_path):
    collision = f"<collision><geometry>{URDF_SHAPES['box'][0]}</geometry></collision>"
    path = robot(tmp_path, collision)
    path.write_text(path.read_text().replace('type="floating"', 'type="fixed"'))
    assert not load_robot(path, ground=0.0).forces


def test_a_free_root_falls_to_the_ground(tmp_path):
    """Robots that walk have no floating joint in their files."""
    path = robot(tmp_path, f"<collision><geometry>{URDF_SHAPES['sphere'][0]}</geometry></collision>")
    text = path.read_text().replace('<link name="world"/>', "")
    path.write_text(text[: text.index("<joint")] + "</robot>")
    assert "the root link base moves freely" in said(path, "--ground", "-0.3", "--free-root")
    assert "the root link base is fixed to ground" in said(path)
    found = stiffmbs.run(load_robot(path, ground=-0.3, free_root=True), duration=1.0)
    assert found["base.z"][-1] == pytest.approx(-0.3 + 0.1 - 9.81 * 0.05 * 0.02**2, abs=1e-6)
    with pytest.raises(InputError, match="found that the root is free, expected it with a URDF file"):
        load_robot(world(tmp_path, floor(), ball()), free_root=True)


def test_surfaces_of_gazebo_in_urdf(tmp_path):
    given = '<gazebo reference="base"><mu1>0.25</mu1><kp value="3e4"/><kd value="1"/><plugin name="p"/></gazebo>'
    path = robot(tmp_path, f"<collision name='c'><geometry>{URDF_SHAPES['box'][0]}</geometry></collision>", given)
    scene = load_robot(path, ground=0.0)
    (contact,) = scene.forces.values()
    assert (contact.friction, contact.stiffness) == (0.25, 3e4)
    assert contact.damping == pytest.approx(2 * np.sqrt(2 * 3e4))
    assert any("<plugin>" in note for note in scene.notes)


def said(path, *options):
    found = CliRunner().invoke(main, ["convert", str(path), *options])
    assert found.exit_code == 0, found.output
    return " ".join(found.output.split())


def test_without_a_ground_links_of_urdf_touch_nothing(tmp_path):
    path = robot(tmp_path, f"<collision><geometry>{URDF_SHAPES['box'][0]}</geometry></collision>")
    assert "states no ground that the links could touch (convert --ground HEIGHT" in said(path, "--contacts")
    assert "box_plane_impact" in said(path, "--ground", "-0.5") and "box_plane_impact" not in said(path)


def test_notes_on_contacts_that_are_left_out(tmp_path):
    meshes = '<collision><geometry><mesh filename="m.stl"/></geometry></collision>' * 2
    path = robot(tmp_path, meshes)
    found = said(path, "--ground", "0")
    assert "contacts of these kinds of shapes are left out: 2 of mesh and plane" in found
    assert "not used (meshes have no contact): link/collision/geometry/mesh filename of base" in found
    mjcf = tmp_path / "r.xml"
    mjcf.write_text(
        '<mujoco><worldbody><geom type="plane" size="1 1 1"/><body name="b" pos="0 0 0.05"><freejoint/><geom name="foot" size="0.1" condim="4"/>'
        '</body><body name="c" pos="0 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/><geom type="ellipsoid" size="0.1 0.1 0.2" pos="1 0 0"/></body>'
        "</worldbody></mujoco>"
    )
    found = said(mjcf, "--contacts")
    assert "contacts have no rolling and drilling friction: foot" in found
    assert "shapes that overlap at the start are pushed apart: foot_on_geom_0 by 0.05 m" in found
    assert "left out: 1 of ellipsoid and sphere" in found
    assert "contacts between the shapes of MJCF are left out (convert --contacts adds them)" in said(mjcf)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ('<sphere radius="-1"/>', "found a negative size"),
        ('<sphere radius="x"/>', "found radius='x'"),
        ('<box size="1 2"/>', "found size='1 2'"),
    ],
)
def test_wrong_shapes_of_urdf_are_refused(tmp_path, shape, message):
    path = robot(tmp_path, f"<collision name='c'><geometry>{shape}</geometry></collision>")
    with pytest.raises(InputError, match=f"link base: the collision c: {message}"):
        load_robot(path, ground=0.0)
    load_robot(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("<radius>0.1</radius>", "<radius>0</radius>", "found a size that is not positive"),
        ("<normal>0 0 1</normal>", "<normal>0 0 0</normal>", "found a normal of length 0"),
        ("<collide_bitmask>1<", "<collide_bitmask>x<", "found 'x' in <collide_bitmask>"),
    ],
)
def test_wrong_collisions_of_sdf_are_refused(tmp_path, old, new, message):
    path = world(tmp_path, floor(), ball(surface=surface(bits=1)))
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=message):
        load_robot(path, contacts=True)


@pytest.mark.parametrize("solref", ["0.02 0", "-100 1", "0 0"])
def test_contacts_without_stiffness_are_refused(tmp_path, solref):
    path = tmp_path / "r.xml"
    path.write_text(
        f'<mujoco><default><geom solref="{solref}"/></default><worldbody><geom type="plane" size="1 1 1"/><body><freejoint/>'
        '<geom size="0.1"/></body></worldbody></mujoco>'
    )
    with pytest.raises(InputError, match=f"found a contact with solref='{solref}'"):
        load_robot(path, contacts=True)
    load_robot(path)


@pytest.mark.parametrize("mu", ["-1", "x", "nan"])
def test_wrong_surfaces_of_gazebo_are_refused(tmp_path, mu):
    path = robot(tmp_path, "", f'<gazebo reference="base"><mu1>{mu}</mu1></gazebo>')
    with pytest.raises(InputError, match=f"<gazebo> of base: found '{mu}' in <mu1>, expected a number of at least 0"):
        load_robot(path, ground=0.0)


def test_options_of_robots_are_refused_with_other_files():
    for option in (["--contacts"], ["--ground", "0"], ["--free-root"]):
        found = CliRunner().invoke(main, ["convert", "scene.yaml", *option])
        assert found.exit_code == 2 and f"found {option[0]}, expected it with a robot alone" in found.output
