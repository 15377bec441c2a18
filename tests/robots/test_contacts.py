"""Contacts of robots: depths at rest, rebounds and sliding distances in closed form and by MuJoCo; energies of random drops."""

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import stiffmbs
from stiffmbs.robots.effective_mass import inverse_masses
from stiffmbs.robots.load import load_robot
from stiffmbs.robots.mjcf.model import read_mjcf
from stiffmbs.robots.overlaps import Overlaps
from stiffmbs.robots.scene.contacts import parts
from tests.random_trees import free_tree_in_mjcf, tree_in_mjcf

G = 9.81
SHAPES = {
    "sphere": ('type="sphere" size=".1"', 0.1, 1),
    "capsule": ('type="capsule" size=".06 .1" euler="90 0 0"', 0.06, 2),
    "box": ('type="box" size=".1 .08 .06"', 0.06, 4),
    "cylinder": ('type="cylinder" size=".06 .1" euler="0 90 0"', 0.06, 2),
    "ellipsoid": ('type="ellipsoid" size=".1 .08 .06"', 0.06, 1),
}
"""Geom, height of its middle on the floor, and number of its points there."""
FLOOR = """<mujoco><option cone="elliptic" timestep="2e-4"/><default><geom solref="{solref}" solimp="{d} {d} 0.01" friction="{mu} 0 0"/></default>
<worldbody><geom name="floor" type="plane" size="1 1 1"/>{bodies}</worldbody></mujoco>"""
BODY = '<body name="body" pos="0 0 {z}" euler="{turn}"><freejoint/><geom name="solid" mass="2" {geom}/></body>'


def on_floor(tmp_path, geom, z, solref="0.02 1", d=0.9, mu=0.5, turn="0 0 0"):
    path = tmp_path / "floor.xml"
    path.write_text(FLOOR.format(solref=solref, d=d, mu=mu, bodies=BODY.format(z=z, geom=geom, turn=turn)))
    return path


def by_mujoco(path, duration, velocity=(0, 0, 0)):
    """Pose of the body, and the velocity of its centre, over time."""
    m = mujoco.MjModel.from_xml_path(str(path))
    d, rows = mujoco.MjData(m), []
    d.qvel[:3] = velocity
    while d.time < duration:
        mujoco.mj_step(m, d)
        rows.append([d.time, *d.qpos[:3], *d.qvel[:3]])
    return np.array(rows).T


@pytest.mark.parametrize("shape", SHAPES)
def test_shapes_rest_on_the_floor_as_deep_as_in_mujoco(tmp_path, shape):
    """Each point has the stiffness m/((1 - d) T^2); they share the weight."""
    geom, height, points = SHAPES[shape]
    path = on_floor(tmp_path, geom, height + 0.01)
    found = stiffmbs.run(load_robot(path, contacts=True), duration=1.0, rtol=1e-8)
    depth = height - found["body.z"][-1]
    assert depth == pytest.approx(G * (1 - 0.9) * 0.02**2 / points, rel=2e-3)
    if shape != "cylinder":  # MuJoCo has four points there
        assert height - by_mujoco(path, 1.0)[3][-1] == pytest.approx(depth, rel=2e-3)


def rebound(zeta):
    """Speed after the contact of a mass with a spring and a damper that do not pull, relative to the speed before."""
    across = np.sqrt(1 - zeta**2)
    angle = np.arctan2(2 * zeta * across, 2 * zeta**2 - 1)
    return np.exp(-zeta / across * angle)


@pytest.mark.parametrize("zeta", [0.1, 0.4, 0.7])
def test_the_rebound_follows_from_the_damping_ratio(tmp_path, zeta):
    path = on_floor(tmp_path, SHAPES["sphere"][0], 0.6, solref=f"0.02 {zeta}", mu=0)
    found = stiffmbs.run(load_robot(path, contacts=True), duration=0.5, output=1e-4, rtol=1e-8)
    speed = -found["body.vz"].min()
    assert speed == pytest.approx(np.sqrt(2 * G * 0.5), rel=1e-3)
    assert found["body.vz"].max() / speed == pytest.approx(rebound(zeta), rel=0.03)
    assert by_mujoco(path, 0.5)[6].max() / speed == pytest.approx(rebound(zeta), rel=0.06)


@pytest.mark.parametrize("shape", ["sphere", "box"])
def test_a_margin_lifts_a_shape(tmp_path, shape):
    """Surfaces with a margin touch at a distance, along the normal of an inclined plane too."""
    geom, height, points = SHAPES[shape]
    path = on_floor(tmp_path, geom + ' margin="0.02"', "{z}", mu=1.5, turn="0 20 0")
    normal = np.array([np.sin(np.radians(20)), 0, np.cos(np.radians(20))])
    start = " ".join(map(str, [0.3, 0, 0.2] + (height + 0.03) * normal))
    tilted = path.read_text().replace('pos="0 0 {z}"', f'pos="{start}"')
    path.write_text(tilted.replace('size="1 1 1"', 'size="1 1 1" pos="0.3 0 0.2" euler="0 20 0" margin="0.01"'))
    found = stiffmbs.run(load_robot(path, contacts=True), duration=0.3, rtol=1e-8)
    place = np.array([found[f"body.{axis}"][-1] for axis in "xyz"]) - [0.3, 0, 0.2]
    depth = G * np.cos(np.radians(20)) * (1 - 0.9) * 0.02**2 / points
    assert place @ normal == pytest.approx(height + 0.03 - depth, abs=1e-5)


def test_a_stiffness_and_damping_stated_directly(tmp_path):
    """solref of -k and -c: the frequency and damping of a unit mass."""
    path = on_floor(tmp_path, SHAPES["sphere"][0], 0.1, solref="-400 -30", d=0.8)
    found = stiffmbs.run(load_robot(path, contacts=True), duration=2.0, rtol=1e-8)
    assert 0.1 - found["body.z"][-1] == pytest.approx(G * (1 - 0.8) / 400, rel=1e-5)
    assert 0.1 - by_mujoco(path, 3.0)[3][-1] == pytest.approx(G * (1 - 0.8) / 400, rel=1e-3)


@pytest.mark.parametrize("mu", [0.2, 0.6])
def test_a_box_slides_to_its_closed_form_distance(tmp_path, mu):
    speed, depth = 2.0, G * (1 - 0.9) * 0.02**2 / 4
    path = on_floor(tmp_path, 'type="box" size=".3 .3 .02"', 0.02 - depth, mu=mu)
    scene = load_robot(path, [("bodies.body.velocity", f"[{speed}, 0, 0]")], contacts=True)
    found = stiffmbs.run(scene, duration=2.0, rtol=1e-7)
    assert found["body.x"][-1] == pytest.approx(speed**2 / (2 * mu * G), rel=3e-3)
    assert by_mujoco(path, 2.0, (speed, 0, 0))[1][-1] == pytest.approx(found["body.x"][-1], rel=0.02)


def test_a_sliding_ball_ends_rolling(tmp_path):
    """With 5/7 of its speed, whatever the friction."""
    path = on_floor(tmp_path, SHAPES["sphere"][0], 0.1 - G * (1 - 0.9) * 0.02**2, mu=0.3)
    scene = load_robot(path, [("bodies.body.velocity", "[1.4, 0, 0]")], contacts=True)
    found = stiffmbs.run(scene, duration=1.0, rtol=1e-8)
    assert found["body.vx"][-1] == pytest.approx(1.0, rel=1e-4)
    assert found["body.wy"][-1] == pytest.approx(1.0 / 0.1, rel=3e-3)


def corners(found, kind, size):
    """Heights of the points that may touch the floor, over time."""
    turned = Rotation.from_quat(np.array([found[f"body.q{k}"] for k in (1, 2, 3, 0)]).T)
    z = found["body.z"]
    if kind == "box":
        arms = np.array([[a, b, c] for a in (1, -1) for b in (1, -1) for c in (1, -1)]) * size
        return np.array([z + turned.apply(arm)[:, 2] for arm in arms])
    lean = turned.apply([0, 0, 1])[:, 2]
    if kind == "capsule":
        return np.array([z + side * size[1] * lean - size[0] for side in (1, -1)])
    if kind == "cylinder":
        return np.array([z + side * size[1] * lean - size[0] * np.sqrt(1 - np.minimum(lean**2, 1)) for side in (1, -1)])
    rows = turned.as_matrix()[:, 2, :] * size
    return np.array([z - np.linalg.norm(rows, axis=1)])


@pytest.mark.parametrize("seed", range(12))
def test_random_drops_do_not_gain_energy(tmp_path, seed):
    """Kinetic energy, weight and springs: none of them is stored in a damper or friction."""
    rng = np.random.default_rng(seed)
    kind = ["box", "capsule", "cylinder", "ellipsoid"][seed % 4]
    size = rng.uniform(0.05, 0.2, 3)[: 2 if kind in ("capsule", "cylinder") else 3]
    geom = f'type="{kind}" size="{" ".join(map(str, size))}"'
    T, zeta, d = 10 ** rng.uniform(-2, -1.3), rng.uniform(0.1, 1), rng.uniform(0.8, 0.95)
    turn = " ".join(map(str, rng.uniform(-180, 180, 3)))
    path = on_floor(tmp_path, geom, 0.5, solref=f"{T} {zeta}", d=d, mu=rng.uniform(0, 1), turn=turn)
    start = [("bodies.body.velocity", str(rng.normal(size=3).tolist())), ("bodies.body.omega", str((5 * rng.normal(size=3)).tolist()))]  # fmt: skip
    scene = load_robot(path, start, contacts=True)
    found = stiffmbs.run(scene, duration=1.0, output=2e-3, rtol=1e-8)
    depth = np.maximum(-corners(found, kind, size), 0)
    springs = (2.0 / ((1 - d) * (T * zeta) ** 2) * depth**2 / 2).sum(axis=0)
    stored = found["energy.kinetic"] + 2.0 * G * found["body.z"] + springs
    assert depth.max() > 1e-4
    np.testing.assert_allclose(found["energy.total"], stored, atol=1e-9 * stored[0])
    assert np.diff(stored).max() < 1e-5 * stored[0]
    assert stored[-1] < 0.999 * stored[0]


def dropped_tree(rng, n):
    """A free tree of shapes of all kinds, above the floor."""

    def turn():
        return " ".join(map(str, rng.uniform(-180, 180, 3)))

    def geom(k):
        kind = rng.choice([*SHAPES])
        sizes = rng.uniform(0.03, 0.08, {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3))
        return (
            f'<geom name="g{k}" type="{kind}" size="{" ".join(map(str, sizes))}" pos="{rng.uniform(-0.05, 0.05)} 0 0" euler="{turn()}" '
            f'friction="{rng.uniform(0, 1)} 0 0" solref="{rng.uniform(0.01, 0.04)} {rng.uniform(0.2, 1)}" solimp="0.9 {rng.uniform(0.7, 0.95)} 0.01"/>'
        )

    def body(k):
        kind, axis = rng.choice(["hinge", "ball", "slide"], p=[0.7, 0.2, 0.1]), " ".join(map(str, rng.normal(size=3)))
        joint = f'<joint type="{kind}" axis="{axis}" damping="{rng.uniform(0.001, 0.1)}"/>' if k else "<freejoint/>"
        away = rng.normal(size=3)
        place = " ".join(map(str, 0.25 * away / np.linalg.norm(away))) if k else "0 0 0.6"
        inner = "".join(body(other) for other in range(n) if parents[other] == k)
        return f'<body name="b{k}" pos="{place}" euler="{turn()}">{joint}{geom(k)}{inner}</body>'

    parents = [-1, *(int(rng.integers(0, k)) for k in range(1, n))]
    return f'<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>{body(0)}</worldbody></mujoco>'


@pytest.mark.sampled(8)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(40))
def test_random_robots_that_fall_do_not_gain_energy(tmp_path, seed):
    """Floor and links touch; joints have dampers."""
    rng, path = np.random.default_rng(seed), tmp_path / "tree.xml"
    path.write_text(dropped_tree(rng, int(rng.integers(1, 6))))
    found = stiffmbs.run(load_robot(path, contacts=True), duration=1.0, output=2e-3)
    energy = found["energy.total"]
    assert found.time[-1] == 1.0
    assert np.diff(energy).max() < 1e-6 * energy[0]
    assert energy[-1] < 0.6 * energy[0]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("make", [tree_in_mjcf, free_tree_in_mjcf])
def test_effective_masses_are_those_of_mujoco(tmp_path, make, seed):
    text = make(np.random.default_rng(seed))
    path = tmp_path / "tree.xml"
    path.write_text(text if isinstance(text, str) else text[0])
    robot, m = read_mjcf(path), mujoco.MjModel.from_xml_path(str(path))
    found = inverse_masses(robot, {})
    for body in range(1, m.nbody):
        assert found[m.body(body).name] == pytest.approx(m.body_invweight0[body, 0], rel=1e-9)


def overlapping(rng, n=7):
    """Spheres that all overlap, on a random tree, with random bits, priorities, stiffnesses and exclusions."""

    def geom(k):
        solref = f"{rng.uniform(0.01, 0.1)} {rng.uniform(0.2, 1)}" if rng.random() < 0.7 else "-300 -20"
        return (
            f'<geom name="g{k}" size="1" contype="{rng.integers(4)}" conaffinity="{rng.integers(4)}" priority="{rng.integers(2)}" '
            f'solmix="{rng.choice([0, 1, 2.5])}" solref="{solref}" solimp="0.1 {rng.uniform(0.3, 0.95)} 0.01" condim="{rng.choice([1, 3])}" '
            f'friction="{rng.uniform(0.1, 1)} 0 0" margin="{rng.choice([0, 0.1])}" gap="{rng.choice([0, 0.2])}"/>'
        )

    def body(k):
        joint = '<joint axis="0 1 0"/>' if rng.random() < 0.6 else ""
        inner = "".join(body(other) for other in range(k + 1, n) if parents[other] == k)
        return f'<body name="b{k}">{joint}<inertial pos="0 0 0.1" mass="1" diaginertia="1 1 1"/>{geom(k)}{inner}</body>'

    parents = [-1, *(int(rng.integers(-1, k)) for k in range(1, n))]
    bodies = "".join(body(k) for k in range(n) if parents[k] < 0)
    pairs = "".join(f'<exclude body1="b{a}" body2="b{b}"/>' for a, b in [rng.choice(n, 2, replace=False)])
    pairs += "".join(
        f'<pair geom1="g{a}" geom2="g{b}" solref="0.03 0.7" solimp="0.1 0.6 0.01" margin="0.07" friction="0.33 0.33 0 0 0"/>'
        for a, b in [rng.choice(n, 2, replace=False)]
    )
    flags = '<flag filterparent="disable"/>' if rng.random() < 0.3 else ""
    return f'<mujoco><option>{flags}</option><worldbody><geom name="g{n}" size="1"/>{bodies}</worldbody><contact>{pairs}</contact></mujoco>'


@pytest.mark.skipif(int(mujoco.__version__.split(".")[0]) < 4, reason="margins have another meaning before MuJoCo 4")
@pytest.mark.parametrize("seed", range(30))
def test_pairs_and_their_stiffness_are_those_of_mujoco(tmp_path, seed):
    path = tmp_path / "overlapping.xml"
    path.write_text(overlapping(np.random.default_rng(seed)))
    m = mujoco.MjModel.from_xml_path(str(path))
    d = mujoco.MjData(m)
    mujoco.mj_forward(m, d)
    expected = {}
    for contact in d.contact:
        pair = frozenset(m.geom(int(geom)).name for geom in contact.geom)
        w2, c = (1 / np.prod(contact.solref) ** 2, 2 / contact.solref[0]) if contact.solref[0] > 0 else -contact.solref
        share = 1 - contact.solimp[1]
        expected[pair] = (
            w2 / share,
            c / np.sqrt(share),
            contact.friction[0] if contact.dim > 1 else 0.0,
            contact.includemargin,
        )
    found = {
        frozenset((each.first.name, each.second.name)): (
            each.softness.stiffness,
            each.softness.damping,
            each.friction,
            each.margin,
        )
        for each in read_mjcf(path, contacts=True).contacts
    }
    assert found.keys() == expected.keys()
    for pair, values in expected.items():
        assert found[pair] == pytest.approx(values, rel=1e-12)


@pytest.mark.parametrize("seed", range(30))
def test_overlaps_are_the_penetrations_of_mujoco(tmp_path, seed):
    """Shapes of any kind at random, above and below the floor, and in each other."""
    rng, path = np.random.default_rng(seed), tmp_path / "tree.xml"
    path.write_text(dropped_tree(rng, 5).replace("0 0 0.6", "0 0 0.1").replace("<worldbody>", "<option/><worldbody>"))
    robot, m = read_mjcf(path, contacts=True), mujoco.MjModel.from_xml_path(str(path))
    d, at = mujoco.MjData(m), Overlaps(robot, {})
    mujoco.mj_forward(m, d)
    deepest = {}
    for contact in d.contact:
        pair = frozenset(m.geom(int(geom)).name for geom in contact.geom)
        deepest[pair] = max(deepest.get(pair, 0.0), -contact.dist)
    for contact in robot.contacts:
        expected = deepest.get(frozenset((contact.first.name, contact.second.name)), 0.0)
        found = max(at.of(i, j) for _, _, i, j in parts(contact))
        if "plane" in (contact.first.kind, contact.second.kind) or expected < contact.first.size[0]:  # else: its middle
            assert max(found, 0.0) == pytest.approx(expected, abs=1e-6)


SPIDER = """<mujoco><option cone="elliptic" timestep="1e-3"/><default><geom condim="1" solimp="0.9 0.9 0.01"/>
<joint type="hinge" axis="0 1 0" stiffness="40" damping="3"/></default><worldbody><geom name="floor" type="plane" size="1 1 1"/>
<body name="torso" pos="0 0 0.5"><freejoint/><geom type="box" size=".15 .1 .03" mass="4"/>{legs}</body></worldbody></mujoco>"""
LEG = """<body name="thigh{k}" pos="{x} {y} 0" euler="0 0 {turn}"><joint name="hip{k}"/><geom type="capsule" fromto="0 0 0 .2 0 -.05" size=".02" mass=".3"/>
<body name="shin{k}" pos=".2 0 -.05"><joint name="knee{k}"/><geom name="foot{k}" type="{foot}" fromto="0 0 0 .05 0 -.25" size=".015" mass=".2"/></body></body>"""


@pytest.mark.parametrize("foot", ["capsule", "cylinder"])
def test_a_robot_stands_as_in_mujoco(tmp_path, foot):
    """Four legs on springs, without friction; the torso is nearer to one side."""
    places = [(0.15, 0.1, 30), (0.15, -0.1, -30), (-0.15, 0.1, 150), (-0.1, -0.1, -150)]
    legs = "".join(LEG.format(k=k, x=x, y=y, turn=turn, foot=foot) for k, (x, y, turn) in enumerate(places))
    path = tmp_path / "spider.xml"
    path.write_text(SPIDER.format(legs=legs))
    found = stiffmbs.run(load_robot(path, contacts=True), duration=4.0)
    m = mujoco.MjModel.from_xml_path(str(path))
    d = mujoco.MjData(m)
    while d.time < 4.0:
        mujoco.mj_step(m, d)
    assert d.ncon == 4
    names = [m.body(body).name for body in range(1, m.nbody)]
    heights = np.array([found[f"{name}.z"][-1] for name in names])
    np.testing.assert_allclose(heights, [d.body(name).xipos[2] for name in names], atol=3e-4)
