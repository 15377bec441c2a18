"""Models in joint coordinates: against MuJoCo, Pinocchio, closed forms and invariances."""

import math
from importlib.util import find_spec

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, InputError, Model, Prismatic, Revolute, SolverError, spatial
from tests.random_trees import free_tree_in_mjcf, tree_in_mjcf, tree_in_urdf
from tests.spatial_loops import slider_crank

SEEDS = range(3)


def of_text(tmp_path, text, name="robot.xml", **options):
    path = tmp_path / name
    path.write_text(text)
    return stiffmbs.joint_space(path, **options)


def by_mujoco(text, q, v):
    """MuJoCo's data at a state, its mass matrix, and its bias without damping."""
    mujoco = pytest.importorskip("mujoco")
    m = mujoco.MjModel.from_xml_string(text)
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    d = mujoco.MjData(m)
    d.qpos[:], d.qvel[:] = q, v
    mujoco.mj_forward(m, d)
    M = np.zeros((m.nv, m.nv))
    mujoco.mj_fullM(m, d, M)
    return m, d, M, d.qfrc_bias - d.qfrc_passive


@pytest.mark.parametrize("seed", SEEDS)
def test_trees_are_those_of_mujoco(tmp_path, seed):
    rng = np.random.default_rng(seed)
    text = tree_in_mjcf(rng)
    space = of_text(tmp_path, text)
    n = len(space.rates)
    q, v, a = rng.uniform(-2, 2, (3, n))
    m, d, M, h = by_mujoco(text, q, v)
    import mujoco

    assert [f"{m.joint(k).name}" for k in range(n)] == [name.rpartition(".")[0] for name in space.coordinates]
    np.testing.assert_allclose(space.mass_matrix(q), M, rtol=1e-10, atol=1e-10 * abs(M).max())
    np.testing.assert_allclose(space.bias(q, v), h, rtol=1e-10, atol=1e-10 * abs(h).max())
    np.testing.assert_allclose(space.inverse_dynamics(q, v, a), M @ a + h, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(space.forward_dynamics(q, v, M @ a + h), a, rtol=1e-9, atol=1e-9)
    for body in range(1, m.nbody):
        name = m.body(body).name
        pose = space.pose(name, q)
        np.testing.assert_allclose(pose.position, d.xpos[body], atol=1e-10)
        np.testing.assert_allclose(pose.rotation, d.xmat[body].reshape(3, 3), atol=1e-10)
        both, rate = np.zeros((6, n)), np.zeros((6, n))
        mujoco.mj_jac(m, d, both[:3], both[3:], d.xpos[body], body)
        mujoco.mj_jacDot(m, d, rate[:3], rate[3:], d.xpos[body], body)
        np.testing.assert_allclose(space.jacobian(name, q), both, atol=1e-10)
        np.testing.assert_allclose(space.jacobian_bias(name, q, v), rate @ v, atol=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_floating_trees_are_those_of_mujoco(tmp_path, seed):
    """MuJoCo's linear velocity of a free joint is that of the body's origin, here of its centre of mass."""
    rng = np.random.default_rng(seed)
    text, centre = free_tree_in_mjcf(rng)
    space = of_text(tmp_path, text)
    joints = rng.uniform(-1, 1, len(space.rates) - 6)
    p = rng.normal(size=4)
    p /= np.linalg.norm(p)
    v, place = rng.normal(size=len(space.rates)), rng.normal(size=3)
    R = np.array(spatial_matrix(p))
    n = len(joints)
    own = np.array([[0, -centre[2], centre[1]], [centre[2], 0, -centre[0]], [-centre[1], centre[0], 0]])
    T = np.zeros((n + 6, n + 6))  # rates here by those of MuJoCo
    T[:n, 6:] = np.eye(n)
    T[n : n + 3, :3], T[n : n + 3, 3:6], T[n + 3 :, 3:6] = np.eye(3), -R @ own, np.eye(3)
    theirs = np.linalg.solve(T, v)
    w = theirs[3:6]
    drift = np.zeros(n + 6)
    drift[n : n + 3] = R @ np.cross(w, np.cross(w, centre))
    _, _, M, h = by_mujoco(text, [*(place - R @ centre), *p, *joints], theirs)
    q = np.array([*joints, *place, *p])
    found = space.mass_matrix(q)
    np.testing.assert_allclose(T.T @ found @ T, M, atol=1e-10 * abs(M).max())
    np.testing.assert_allclose(T.T @ (space.bias(q, v) + found @ drift), h, atol=1e-10 * abs(h).max())


def spatial_matrix(p):
    w, x, y, z = p
    return (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )


@pytest.mark.skipif(find_spec("pinocchio") is None, reason="needs Pinocchio")
@pytest.mark.parametrize("seed", SEEDS)
def test_trees_are_those_of_pinocchio(tmp_path, seed):
    import pinocchio

    rng = np.random.default_rng(seed)
    text = tree_in_urdf(rng)
    space = of_text(tmp_path, text, "robot.urdf")
    model = pinocchio.buildModelFromXML(text)
    data = model.createData()
    order = [model.joints[model.getJointId(name.rpartition(".")[0])].idx_v for name in space.coordinates]
    q, v, a = rng.uniform(-2, 2, (3, len(order)))
    theirs = [own[np.argsort(order)] for own in (q, v, a)]
    M = pinocchio.crba(model, data, theirs[0])
    M = np.triu(M) + np.triu(M, 1).T
    np.testing.assert_allclose(space.mass_matrix(q), M[np.ix_(order, order)], atol=1e-10 * abs(M).max())
    tau = pinocchio.rnea(model, data, *theirs)[order]
    np.testing.assert_allclose(space.inverse_dynamics(q, v, a), tau, atol=1e-10 * abs(tau).max())
    link = f"link{len(order) - 1}"
    J = pinocchio.computeFrameJacobian(model, data, theirs[0], model.getFrameId(link), pinocchio.LOCAL_WORLD_ALIGNED)
    np.testing.assert_allclose(space.jacobian(link, q), J[:, order], atol=1e-10)


CRANK, ROD = 0.2, 0.5


def crank_slider(drive=False, **inputs):
    """A crank about the origin, a rod and a slider along x in the plane, without gravity."""
    model = Model("crank-slider", gravity=(0, 0), **inputs)
    angle = 0.4
    pin = np.array([CRANK * math.cos(angle), CRANK * math.sin(angle)])
    end = np.array([pin[0] + math.sqrt(ROD**2 - pin[1] ** 2), 0.0])
    crank = model.add("crank", Body(mass=1.5, inertia=0.02, position=tuple(pin / 2), angle=angle))
    tilt = math.atan2(-pin[1], end[0] - pin[0])
    rod = model.add("rod", Body(mass=0.8, inertia=0.03, position=tuple((pin + end) / 2), angle=tilt))
    model.add("slider", Body(mass=2.0, inertia=1.0, position=tuple(end)))
    model.add("bearing", Revolute(i=crank.at(-CRANK / 2, 0), j="ground"))
    model.add("pin", Revolute(i=rod.at(-ROD / 2, 0), j=crank.at(CRANK / 2, 0)))
    model.add("wrist", Revolute(i="slider", j=rod.at(ROD / 2, 0)))
    model.add("guide", Prismatic(i="slider", j="ground"))
    if drive:
        model.add("motor", stiffmbs.Drive(joint="bearing", position="0.4 + 3*t + 2*t^2"))
    return model


def closed_form(angle):
    """Inertia of the crank-slider about its crank: sums of m v^2 + I w^2 at unit rate."""
    s, c = math.sin(angle), math.cos(angle)
    tilt = -math.asin(CRANK * s / ROD)
    rate = -CRANK * c / (ROD * math.cos(tilt))
    slider = -CRANK * s - ROD * math.sin(tilt) * rate
    rod = (-CRANK * s - ROD / 2 * math.sin(tilt) * rate, CRANK * c + ROD / 2 * math.cos(tilt) * rate)
    crank = 1.5 * (CRANK / 2) ** 2 + 0.02
    return crank + 0.8 * (rod[0] ** 2 + rod[1] ** 2) + 0.03 * rate**2 + 2.0 * slider**2


def test_loop_is_that_of_its_closed_form():
    """Generalised inertia I(q), bias I' v^2 / 2 (Eksergian's equation)."""
    space = stiffmbs.joint_space(crank_slider(), independent=["bearing.angle"])
    assert space.coordinates == ("bearing.angle",)
    for angle in (0.4, 2.0, 3.9, 7.0):
        np.testing.assert_allclose(space.mass_matrix([angle]), [[closed_form(angle)]], rtol=1e-10)
        step = 1e-5
        slope = (closed_form(angle + step) - closed_form(angle - step)) / (2 * step)
        np.testing.assert_allclose(space.bias([angle], [1.7]), [0.5 * slope * 1.7**2], rtol=1e-6, atol=1e-9)
        place = CRANK * math.cos(angle) + math.sqrt(ROD**2 - (CRANK * math.sin(angle)) ** 2)
        np.testing.assert_allclose(space.pose("slider", [angle]).position, [place, 0.0], atol=1e-10)


def test_effort_of_a_drive_is_that_of_a_run():
    run = stiffmbs.run(crank_slider(drive=True), duration=0.5, rtol=1e-10)
    space = stiffmbs.joint_space(crank_slider(drive=True), independent=["bearing.angle"])
    for row in (0, len(run.t) // 3, -1):
        q, v, a = ([run[f"bearing.angle{order}"][row]] for order in ("", "_rate", "_acceleration"))
        found = space.actuator_efforts(q, v, a)
        assert found.actuators == ("motor",)
        assert found.redundant == 0
        np.testing.assert_allclose(found.values, run["motor.effort"][row], rtol=1e-7)


def test_redundant_actuators_share_the_least_efforts():
    space = stiffmbs.joint_space(crank_slider(), independent=["bearing.angle"])
    q, v, a = [1.1], [2.0], [5.0]
    needed = space.inverse_dynamics(q, v, a)
    found = space.actuator_efforts(q, v, a, ["bearing.angle", "pin.angle"])
    alone = space.actuator_efforts(q, v, a, ["pin.angle"])
    ratio = needed[0] / alone.values[0]  # rate of the pin by that of the crank
    np.testing.assert_allclose(found.values, needed * np.array([1.0, ratio]) / (1 + ratio**2), rtol=1e-10)
    assert found.redundant == 1
    assert "least norm" in repr(found)


def test_efforts_that_a_tiny_mechanism_misses_are_told():
    scene = """
bodies:
  a: {mass: 1e-9, inertia: 1e-18, position: [1e-4, 0]}
  b: {mass: 1e-9, inertia: 1e-18, position: [3e-4, 0]}
joints:
  h: {type: revolute, i: {body: a, point: [-1e-4, 0]}, j: ground}
  k: {type: revolute, i: {body: b, point: [-1e-4, 0]}, j: {body: a, point: [1e-4, 0]}}
"""
    space = stiffmbs.joint_space(stiffmbs.read_scene(scene))
    with pytest.raises(InputError, match=r"along k.angle_rate is missing"):
        space.actuator_efforts([0.1, 0.2], [0, 0], [1, 1], ["h.angle"])


def chain_in_space(rng):
    """A tree in space with revolute, prismatic, cylindrical, universal and spherical joints, and springs."""
    model = spatial.Model("chain", gravity=(0.3, -0.5, -9.81))
    place, before = np.zeros(3), None
    kinds = [spatial.Revolute, spatial.Universal, spatial.Cylindrical, spatial.Spherical, spatial.Prismatic]
    for k in rng.permutation(len(kinds)):
        turn = rng.normal(size=4)
        turn /= np.linalg.norm(turn)
        arm = rng.uniform(0.2, 0.5, 3)
        place = place + arm
        body = model.add(
            f"b{k}",
            spatial.Body(mass=rng.uniform(1, 2), inertia=tuple(rng.uniform(0.09, 0.11, 3)), position=tuple(place)),
        )
        at = spatial.Marker(
            body="ground" if before is None else before[0], point=tuple(place - arm / 2 - (before[1] if before else 0))
        )
        i = body.at(*(-arm / 2))
        if kinds[k] is spatial.Universal:
            i = body.at(*(-arm / 2), {"z": (1, 0, 0)})
        model.add(f"j{k}", kinds[k](i=i, j=at))
        before = (f"b{k}", place)
    model.add("spring", spatial.SpringDamper(i="ground", j=before[0], stiffness=40.0, free_length=0.3))
    return model


def energy(space, q, v):
    channels = space.state(q, v).channels
    return channels["energy.kinetic"] + channels["energy.potential"]


def random_pose(space, rng, size=0.6):
    return space.moved(space.q, rng.uniform(-size, size, len(space.rates)))


def on_a_plane(rng):
    """A body that slides on a plane, with a nut on a screw, an arm that a coupler turns with another, and a spring with turns."""
    model = spatial.Model("plane", gravity=(0.2, 1.0, -9.81))
    inertia = (0.1, 0.12, 0.08)
    base = model.add("base", spatial.Body(mass=2, inertia=inertia, center_of_mass=(0.1, 0.05, 0.0)))
    nut = model.add("nut", spatial.Body(mass=1, inertia=inertia, position=(0.3, 0, 0.4)))
    arms = [model.add(f"arm{k}", spatial.Body(mass=1, inertia=inertia, position=(0.4 * k, 0.5, 0))) for k in (1, 2)]
    model.add(
        "table", spatial.Planar(i=base.at(0, 0, 0), j=spatial.Marker(body="ground", orientation={"z": (0.3, 0.1, 1)}))
    )
    model.add("thread", spatial.Screw(i="nut", j=base.at(0.3, 0, 0.4, {"z": (1, 0, 1)}), pitch=0.3))
    for k, arm in enumerate(arms, start=1):
        model.add(f"hinge{k}", spatial.Revolute(i=arm.at(-0.2, 0, 0), j=base.at(0.4 * k - 0.2, 0.5, 0)))
    model.add("belt", spatial.Coupler(joint_1="hinge1", joint_2="hinge2", scale=-2.0))
    along = {"z": (1, 0, 1)}
    model.add("spring", spatial.TorsionSpring(i=nut.at(0, 0, 0, along), j=base.at(0, 0, 0, along), stiffness=3.0))
    return model


MODELS = {
    "on_a_plane": on_a_plane,
    "chain": chain_in_space,
    "slider_crank": lambda rng: slider_crank(0.7, cross=True),
    "balls": lambda rng: slider_crank(0.7),
    "plane": lambda rng: crank_slider(),
    "free": lambda rng: free_body(),
}


def free_body():
    model = spatial.Model("free", gravity=(0, 0, -9.81))
    body = model.add("b", spatial.Body(mass=2, inertia=(0.1, 0.2, 0.25), center_of_mass=(0.1, 0.0, 0.2)))
    arm = model.add("arm", spatial.Body(mass=1, inertia=(0.1, 0.1, 0.05), position=(0.4, 0, 0)))
    model.add("hinge", spatial.Revolute(i=arm.at(-0.2, 0, 0), j=body.at(0.2, 0, 0)))
    model.add("spring", spatial.SpringDamper(i="ground", j=arm.at(0.2, 0.1, 0), stiffness=40.0, free_length=0.3))
    return model


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("seed", SEEDS)
def test_power_of_efforts_is_the_rate_of_energy(name, seed):
    """v^T (M a + h) = dE/dt; M is symmetric and positive; kinetic energy is v^T M v / 2."""
    rng = np.random.default_rng(seed)
    space = stiffmbs.joint_space(MODELS[name](rng))
    q = random_pose(space, rng)
    v, a = rng.normal(size=(2, len(space.rates)))
    M = space.mass_matrix(q)
    np.testing.assert_allclose(M, M.T, atol=1e-12 * abs(M).max())
    assert np.linalg.eigvalsh(M)[0] > 0
    np.testing.assert_allclose(space.state(q, v).channels["energy.kinetic"], 0.5 * v @ M @ v, rtol=1e-9)
    tau, h = space.inverse_dynamics(q, v, a), 1e-4
    before, after = (
        energy(space, space.moved(q, sign * h * v + 0.5 * h**2 * a), v + sign * h * a) for sign in (-1.0, 1.0)
    )
    np.testing.assert_allclose((after - before) / (2 * h), v @ tau, rtol=1e-5, atol=1e-5 * abs(tau).max())
    np.testing.assert_allclose(space.forward_dynamics(q, v, tau), a, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("name", MODELS)
def test_jacobians_are_derivatives_of_poses(name):
    rng = np.random.default_rng(4)
    space = stiffmbs.joint_space(MODELS[name](rng))
    q, v, h = random_pose(space, rng), rng.normal(size=len(space.rates)), 1e-5
    body = space._data.bodies and list(space._data.bodies)[-1]
    n = space._data.dimensions
    sides = [space.moved(q, sign * h * v) for sign in (-1.0, 1.0)]
    before, after = (space.pose(body, side) for side in sides)
    J = space.jacobian(body, q)
    np.testing.assert_allclose((after.position - before.position) / (2 * h), (J @ v)[:n], atol=1e-8)
    turned = after.rotation @ before.rotation.T / (4 * h)
    spin = [turned[1, 0] - turned[0, 1]]
    if n == 3:
        spin = [turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], *spin]
    np.testing.assert_allclose(spin, (J @ v)[n:], atol=1e-8)
    rates = [space.jacobian(body, side) @ v for side in sides]
    np.testing.assert_allclose((rates[1] - rates[0]) / (2 * h), space.jacobian_bias(body, q, v), atol=1e-6)


@pytest.mark.parametrize("name", MODELS)
def test_linearisation_is_that_of_forward_dynamics(name):
    rng = np.random.default_rng(5)
    space = stiffmbs.joint_space(MODELS[name](rng))
    n = len(space.rates)
    q, h = random_pose(space, rng, 0.3), 1e-5
    v, tau = rng.normal(size=(2, n))
    found = space.linearise(q, v, tau)
    by_q, by_v = np.zeros((n, n)), np.zeros((n, n))
    for k, e in enumerate(h * np.eye(n)):
        by_q[:, k] = (
            space.forward_dynamics(space.moved(q, e), v, tau) - space.forward_dynamics(space.moved(q, -e), v, tau)
        ) / (2 * h)
        by_v[:, k] = (space.forward_dynamics(q, v + e, tau) - space.forward_dynamics(q, v - e, tau)) / (2 * h)
    scale = max(abs(by_q).max(), abs(by_v).max(), 1.0)
    np.testing.assert_allclose(found.a[n:, :n], by_q, atol=2e-6 * scale)
    np.testing.assert_allclose(found.a[n:, n:], by_v, atol=2e-6 * scale)
    np.testing.assert_allclose(found.a[:n, n:], np.eye(n), atol=1e-7)
    np.testing.assert_allclose(found.b[n:] @ space.mass_matrix(q), np.eye(n), atol=1e-8)
    np.testing.assert_allclose(found.c, np.eye(2 * n))


def test_coordinates_are_those_of_a_simulation():
    space = stiffmbs.joint_space("examples/cart_pendulum.yaml")
    sim = stiffmbs.simulation("examples/cart_pendulum.yaml")
    assert space.coordinates == sim.joints
    q, v = np.array([0.1, 7.0]), np.array([0.2, -1.0])
    sim.reset(space.state(q, v))
    np.testing.assert_allclose(sim.joint_coordinates, q, atol=1e-12)
    np.testing.assert_allclose(sim.joint_rates, v, atol=1e-12)


DOUBLE_PENDULUM = """
gravity: [0, -9.81]
inputs: {F: 0}
bodies:
  cart: {mass: 1 kg, inertia: 0.1 kg m^2}
  lower: {mass: 0.3 kg, inertia: 0.01 kg m^2, position: [0, 0.25], angle: 90 deg}
  upper: {mass: 0.2 kg, inertia: 0.005 kg m^2, position: [0, 0.7], angle: 90 deg}
states:
  lag: {rate: 5*(F - lag)}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: {body: lower, point: [-0.25, 0]}, j: cart}
  knee: {type: revolute, i: {body: upper, point: [-0.2, 0]}, j: {body: lower, point: [0.25, 0]}}
forces:
  push: {type: force, i: cart, force: [F, 0]}
"""


def test_regulator_from_the_linearisation_holds_a_double_pendulum_upright():
    from scipy.linalg import solve_continuous_are

    scene = stiffmbs.read_scene(DOUBLE_PENDULUM.replace("states:\n  lag: {rate: 5*(F - lag)}\n", ""))
    space = stiffmbs.joint_space(scene)
    linear = space.linearise()
    assert linear.inputs == ("F",)
    riccati = solve_continuous_are(linear.a, linear.b, np.diag([10.0, 10, 10, 1, 1, 1]), np.eye(1))
    sim = stiffmbs.simulation(scene, solver="projected", scheme="rk4", step=1e-3)
    sim.reset(joints={"hinge": space.q[1] + 0.1, "knee": space.q[2] - 0.15})
    for _ in range(6000):
        x = np.concatenate([sim.joint_coordinates - space.q, sim.joint_rates])
        sim.step(1e-3, -(linear.b.T @ riccati) @ x)
    assert np.abs(x).max() < 0.01


def test_inputs_and_states_of_a_scene_are_in_the_linearisation():
    """The effect of a force on the cart is that of an effort along the rail; a lag follows it."""
    space = stiffmbs.joint_space(stiffmbs.read_scene(DOUBLE_PENDULUM))
    found = space.linearise(inputs=["F", "rail.displacement"], outputs=["upper.x", "lag"])
    assert found.a.shape == (7, 7)
    np.testing.assert_allclose(found.b[:6, 0], found.b[:6, 1], atol=1e-7)
    np.testing.assert_allclose(found.a[6], [0, 0, 0, 0, 0, 0, -5], atol=1e-7)
    np.testing.assert_allclose(found.b[6], [5.0, 0.0], atol=1e-7)
    np.testing.assert_allclose(found.c[0], [1.0, -0.7, -0.2, 0, 0, 0, 0], atol=1e-7)
    np.testing.assert_allclose(found.c[1], [0, 0, 0, 0, 0, 0, 1], atol=1e-7)


@pytest.mark.parametrize("seed", SEEDS)
def test_inverse_kinematics_is_the_inverse_of_the_pose(tmp_path, seed):
    rng = np.random.default_rng(seed)
    space = of_text(tmp_path, tree_in_mjcf(rng, 8))
    goal = space.pose("link7", rng.uniform(-0.5, 0.5, 8))
    q = space.inverse_kinematics("link7", goal.position, goal.rotation if seed else None)
    found = space.pose("link7", q)
    np.testing.assert_allclose(found.position, goal.position, atol=1e-8)
    if seed:
        np.testing.assert_allclose(found.rotation, goal.rotation, atol=1e-8)


def test_inverse_kinematics_of_a_loop():
    space = stiffmbs.joint_space(crank_slider(), independent=["bearing.angle"])
    place = space.pose("rod", [1.3]).position
    np.testing.assert_allclose(space.inverse_kinematics("rod", place), [1.3], atol=1e-8)


def test_results_depend_on_their_arguments_alone():
    one, other = (stiffmbs.joint_space(crank_slider(), independent=["bearing.angle"]) for _ in range(2))
    other.bias([-3.0], [5.0])
    assert np.array_equal(one.bias([1.3], [2.0]), other.bias([1.3], [2.0]))


def test_driven_coordinates_may_be_independent_and_guides_too():
    space = stiffmbs.joint_space(crank_slider(), independent=["guide.displacement"])
    q = space.q - 0.01
    angle = stiffmbs.joint_space(crank_slider(), independent=["bearing.angle"])
    found = angle.inverse_kinematics("slider", space.pose("slider", q).position)
    rate = angle.jacobian("slider", found)[0, 0]
    np.testing.assert_allclose(space.mass_matrix(q) * rate**2, angle.mass_matrix(found), rtol=1e-8)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda s: s.mass_matrix([1, 2]), r"q: found an array of shape \(2,\), expected \(1,\), one number for each of bearing"),
        (lambda s: s.bias([1.0], [np.nan]), "v: found nan for bearing.angle_rate, expected a finite number"),
        (lambda s: s.bias([1.0], "fast"), "v: found 'fast', expected numbers"),
        (lambda s: s.mass_matrix([500.0]), "q: found a joint coordinate 500 rad"),
        (lambda s: s.pose("rood", [1.0]), "unknown body 'rood'.*did you mean 'rod'"),
        (lambda s: s.jacobian(7, [1.0]), "marker: found 7, expected a body"),
        (lambda s: s.actuator_efforts([1.0], [0.0], [1.0], ["engine"]), "actuator 'engine': found no such coordinate"),
        (lambda s: s.actuator_efforts([1.0], [0.0], [1.0], []), "cannot give these accelerations"),
        (lambda s: s.inverse_kinematics("slider", [3.0, 0.0]), r"the nearest pose of 'slider' is 2\.3 m away"),
        (lambda s: s.inverse_kinematics("slider"), "found no position and no rotation"),
        (lambda s: s.inverse_kinematics("slider", [1.0]), r"position: found \[1\.\], expected finite numbers"),
        (lambda s: s.inverse_kinematics("slider", rotation=2 * np.eye(2)), "a matrix that is no rotation"),
        (lambda s: s.inverse_kinematics("slider", [0.6, 0.0], tolerance=0.0), r"tolerance: found 0\.0, expected a number greater"),
        (lambda s: s.inverse_kinematics("slider", [0.6, 0.0], tolerance="1"), "tolerance: found '1', expected a number greater"),
        (lambda s: s.inverse_kinematics("slider", [0.6, 0.0], most_iterations="9"), "most_iterations: found '9', expected a whole number"),
        (lambda s: s.inverse_kinematics("slider", [0.6, 0.0], most_iterations=0), "most_iterations: found 0, expected a whole number"),
        (lambda s: s.linearise(inputs="bearing.angle"), "inputs: found the text 'bearing.angle', expected a list"),
        (lambda s: s.linearise(outputs="rod.x"), "outputs: found the text 'rod.x', expected a list"),
        (lambda s: s.actuator_efforts([1.0], [0.0], [1.0], 3), "actuators: found 3, expected a list of names"),
        (lambda s: s.linearise(inputs=["engine"]), "input 'engine': found no such force"),
        (lambda s: s.linearise(outputs=["pin.fx"]), "output 'pin.fx': found no coordinate"),
    ],
)  # fmt: skip
def test_invalid_arguments_are_refused(call, sentence):
    with pytest.raises(InputError, match=sentence):
        call(stiffmbs.joint_space(crank_slider(), independent=["bearing.angle"]))


def test_invalid_coordinates_are_refused():
    for given, sentence in (
        (["crank"], "independent: found 'crank'"),
        (["bearing.angle", "pin.angle"], "found 2 coordinates, expected 1"),
        ("bearing.angle", "independent: found the text 'bearing.angle', expected a list of names"),
        (3, "independent: found 3, expected a list of names"),
    ):
        with pytest.raises(InputError, match=sentence):
            stiffmbs.joint_space(crank_slider(), independent=given)


def test_dead_point_and_open_loop_are_reported():
    space = stiffmbs.joint_space(crank_slider(), independent=["guide.displacement"])
    to_the_end = CRANK + ROD - space.pose("slider", space.q).position[0]
    with pytest.raises(SolverError, match=r"guide\.displacement do not determine the motion in this pose"):
        space.mass_matrix(space.q + to_the_end)
    with pytest.raises((InputError, SolverError)):
        space.mass_matrix(space.q + to_the_end + 0.2)


def test_quaternion_of_length_zero_is_refused():
    space = stiffmbs.joint_space(free_body())
    with pytest.raises(InputError, match=r"a quaternion of length 0 at b\.q0"):
        space.mass_matrix(np.zeros(8))


def test_motion_without_mass_is_reported():
    model = Model("massless", gravity=(0, 0))
    model.add("b", Body(mass=1, inertia=1))
    space = stiffmbs.joint_space(model)
    assert space.coordinates == ("b.x", "b.y", "b.angle")
    space._tree._lists["mass"][2] = 0.0
    with pytest.raises(SolverError, match=r"along b\.omega has no mass"):
        space.forward_dynamics(space.q, space.v)


def test_friction_by_reactions_is_refused():
    model = crank_slider()
    model.add("rub", stiffmbs.JointFriction(joint="bearing", friction=0.1, radius=0.02))
    with pytest.raises(InputError, match=r"forces\.rub: its forces depend on reactions"):
        stiffmbs.joint_space(model)


def test_rolling_is_refused():
    with pytest.raises(InputError, match="constrain velocities only"):
        stiffmbs.joint_space("examples/rolling_disc.yaml")


def four_bar(crank, rod, rocker, base, angle):
    """Joints B and C of a four-bar with its rocker on the left, as complex numbers."""
    B = crank * np.exp(1j * angle)
    reach = abs(base - B)
    inner = math.acos((rod**2 + reach**2 - rocker**2) / (2 * rod * reach))
    return B, B + rod * (base - B) / reach * np.exp(1j * inner)


def four_bar_model(crank, rod, rocker, base, angle):
    B, C = four_bar(crank, rod, rocker, base, angle)
    model = Model("four-bar", gravity=(0, 0))
    ends = {"crank": (0j, B, crank), "rod": (B, C, rod), "rocker": (base + 0j, C, rocker)}
    bar = {}
    for name, (start, end, length) in ends.items():
        middle = (start + end) / 2
        own = Body(mass=1, inertia=0.02, position=(middle.real, middle.imag), angle=float(np.angle(end - start)))
        bar[name] = model.add(name, own)
        bar[name] = bar[name].at(-length / 2, 0), bar[name].at(length / 2, 0)
    model.add("bearing", Revolute(i=bar["crank"][0], j="ground"))
    model.add("pin", Revolute(i=bar["rod"][0], j=bar["crank"][1]))
    model.add("pivot", Revolute(i=bar["rocker"][0], j=stiffmbs.Marker(body="ground", point=(base, 0))))
    model.add("knee", Revolute(i=bar["rocker"][1], j=bar["rod"][1]))
    return model


@pytest.mark.parametrize("lengths", [(0.3, 0.8627, 0.4894, 0.7033), (0.3, 0.8, 0.403, 0.701)])
def test_loops_remain_closed_in_the_same_way(lengths):
    """The rocker remains on its side at all angles of the crank, though its other side comes near at 0 or 180 degrees."""
    space = stiffmbs.joint_space(four_bar_model(*lengths, 2.3), independent=["bearing.angle"])
    for change in np.linspace(-7, 7, 29):
        q = space.q + change
        _, C = four_bar(*lengths, q[0])
        middle = (lengths[3] + C) / 2
        np.testing.assert_allclose(space.pose("rocker", q).position, [middle.real, middle.imag], atol=1e-8)


def test_dead_point_on_the_way_is_reported():
    """A parallelogram may continue in two ways beyond 180 degrees."""
    space = stiffmbs.joint_space(four_bar_model(0.3, 0.8, 0.3, 0.8, 1.0), independent=["bearing.angle"])
    np.testing.assert_allclose(space.pose("rod", [3.0]).rotation, np.eye(2), atol=1e-6)
    with pytest.raises(SolverError, match=r"bearing\.angle do not determine the motion at .* = 3\.14.*, on the way"):
        space.mass_matrix([4.0])


def test_both_signs_of_a_quaternion_are_one_pose():
    space = stiffmbs.joint_space("examples/heavy_top.yaml")
    for q in (space.q, space.moved(space.q, [0.1, 0.2, 0.3])):
        other = np.array([*q[:3], *-q[3:]])
        np.testing.assert_allclose(space.mass_matrix(other), space.mass_matrix(q), atol=1e-12)
        np.testing.assert_allclose(space.moved(other, [0, 0, 0]), other, atol=1e-12)


def test_inverse_kinematics_of_a_body_with_few_motions():
    """One joint in space: five of the six rows of the pose depend on one."""
    model = spatial.Model("arm", gravity=(0, 0, 0))
    arm = model.add("arm", spatial.Body(mass=1, inertia=(0.1, 0.1, 0.1), position=(0.5, 0, 0)))
    model.add("hinge", spatial.Revolute(i=arm.at(-0.5, 0, 0), j="ground"))
    space = stiffmbs.joint_space(model)
    for angle in (0.3, 1.0, 2.5):
        goal = space.pose("arm", [angle])
        np.testing.assert_allclose(space.inverse_kinematics("arm", goal.position, goal.rotation), [angle], atol=1e-9)


@pytest.mark.parametrize("joint", ["bearing", "pin", "pivot", "knee"])
def test_a_drive_of_any_joint_of_a_loop_is_an_actuator(joint):
    """Its power is that of the effort along the crank's angle."""
    model = four_bar_model(0.3, 0.8627, 0.4894, 0.7033, 2.3)
    space = stiffmbs.joint_space(model, independent=["bearing.angle"])
    needed = space.inverse_dynamics([2.0], [1.5], [2.0])
    model.add("motor", stiffmbs.Drive(joint=joint, position="t"))
    driven = stiffmbs.joint_space(model, independent=["bearing.angle"])
    rate = driven.state([2.0], [1.5]).channels[f"{joint}.angle_rate"]
    np.testing.assert_allclose(driven.actuator_efforts([2.0], [1.5], [2.0]).values * rate, needed * 1.5, rtol=1e-8)
