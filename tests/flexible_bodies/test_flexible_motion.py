"""Flexible bodies in scenes: conservation, the rigid limit, natural modes, statics, and the reference mechanism."""

from pathlib import Path

import numpy as np
import pytest

from stiffmbs import load_scene
from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.run import run
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.compile.quaternions import rotated
from stiffmbs.compile.state import State
from stiffmbs.elements.spatial.flexible.layout import parts
from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.matrices import from_archive
from stiffmbs.flexible_bodies.read import read_flexible_body
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.model.flexible import _Parts
from stiffmbs.model.read_scene import read_scene
from stiffmbs.studies.simulation import simulation

from .bars import HEIGHT, LENGTH, MASS, REFERENCES, WIDTH, E, bar

BODY = """
matrices: bar.npz
units: {length: 1 m}
interfaces:
  a: {group: start}
  b: {group: end}
modes: 3
"""
SCENE = """
name: Bar
dimensions: 3
gravity: GRAVITY
bodies:
  bar:
    type: flexible
    matrices: bar.npz
    units: {length: 1 m}
    interfaces:
      a: {group: start}
      b: {group: end}
    modes: 3
    MOTION
joints: JOINTS
run: {duration: 20 ms, points: 21, rtol: 1e-9, solver: radau}
"""
PIN = "{pin: {type: revolute, i: bar.a, j: {body: ground, point: [0, 15 mm, 10 mm]}}}"
CLAMP = PIN.replace("revolute", "fixed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("bar")
    model = bar(found, "hexahedron27", along=4, across=1)
    ends = {name: np.flatnonzero(np.abs(model.nodes[:, 0] - x) < 1e-9) for name, x in (("start", 0.0), ("end", LENGTH))}
    arrays = {"nodes": model.nodes, "M": model.mass.toarray()}
    np.savez(found / "bar.npz", K=model.stiffness.toarray(), **arrays, **ends)
    np.savez(found / "stiff.npz", K=1e6 * model.stiffness.toarray(), **arrays, **ends)
    (found / "bar.yaml").write_text(BODY)
    return found


def scene(folder: Path, joints="{}", motion="", gravity="[0, 0, 0]", more="", **changes):
    path = folder / "scene.yaml"
    path.write_text(SCENE.replace("GRAVITY", gravity).replace("JOINTS", joints).replace("MOTION", motion) + more)
    return load_scene(path, [(name.replace("__", "."), value) for name, value in changes.items()])


def _nodes(folder, solution):
    """Return positions and velocities of all nodes, shapes (times, nodes, 3)."""
    body, model = reduced_body(read_flexible_body(str(folder / "bar.yaml")), folder), from_archive((folder / "bar.npz").read_bytes(), 1, 1, 1)  # fmt: skip
    names = [f"bar.modes{1 + k // 3}" for k in range(len(body.frequencies))]
    modal = np.array([solution[f"{name}.{'xyz'[k % 3]}"] for k, name in enumerate(names)])
    rates = np.array([solution[f"{name}.v{'xyz'[k % 3]}"] for k, name in enumerate(names)])
    shapes = np.sqrt(body.mass) * body.modes
    offset, rate = ((shapes @ each).T.reshape(modal.shape[1], -1, 3) for each in (modal, rates))
    turn, centre, velocity, spin = (
        np.array([solution[f"bar.frame.{name}"] for name in each.split()]).T
        for each in ("q0 q1 q2 q3", "x y z", "vx vy vz", "wx wy wz")
    )
    own = model.nodes - body.centre + offset
    turned = np.array([rotated(p, x) for p, x in zip(turn, own, strict=True)])
    moved = np.array([rotated(p, x) for p, x in zip(turn, rate + np.cross(spin[:, None], own), strict=True)])
    return model, centre[:, None] + turned, velocity[:, None] + moved, offset


FREE = "velocity: [1, 2, 3]\n    omega: [30, 50, 200]"


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["radau", "projected"])
def test_free_flight_keeps_energy_momentum_and_angular_momentum(folder, solver):
    solution = run(scene(folder, motion=FREE, run__solver=solver, run__rtol="1e-11"))
    model, position, velocity, offset = _nodes(folder, solution)
    by_mass = np.array([(model.mass @ v.ravel()).reshape(-1, 3) for v in velocity])
    kinetic = np.einsum("tij,tij->t", velocity, by_mass) / 2
    strain = np.array([u.ravel() @ (model.stiffness @ u.ravel()) for u in offset]) / 2
    assert np.abs(offset).max() > 5e-6  # the bar does deform
    for kept in (kinetic + strain, by_mass.sum(axis=1), np.cross(position, by_mass).sum(axis=1)):
        assert np.abs(kept - kept[0]).max() < 1e-10 * np.abs(kept).max()
    np.testing.assert_allclose(solution["energy.kinetic"], kinetic, rtol=1e-6)
    np.testing.assert_allclose(solution["energy.total"], solution["energy.total"][0], rtol=1e-8)


@pytest.mark.long
def test_interfaces_are_at_their_nodes(folder):
    solution = run(scene(folder, motion=FREE))
    model, position, velocity, _ = _nodes(folder, solution)
    end = model.groups["end"]
    for names, expected in (("x y z", position), ("vx vy vz", velocity)):
        found = np.array([solution[f"bar.b.{name}"] for name in names.split()]).T
        np.testing.assert_allclose(found, expected[:, end].mean(axis=1), atol=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_solvers_agree(folder, solver):
    expected, found = (
        run(scene(folder, PIN, gravity="[0, -9.81, 0]", run__solver=each, bodies__bar__damping="0.02"))
        for each in ("radau", solver)
    )
    for name in ("bar.b.x", "bar.b.y"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-8)
    np.testing.assert_allclose(found["pin.fy"], expected["pin.fy"], atol=1e-4 * np.abs(expected["pin.fy"]).max())


@pytest.mark.long
def test_presolve_changes_nothing(folder):
    expected, found = (
        run(scene(folder, PIN, motion="omega: [0, 0, 20]", run__presolve=on)) for on in ("true", "false")
    )
    np.testing.assert_allclose(found["bar.b.y"], expected["bar.b.y"], atol=1e-9)


@pytest.mark.parametrize("rtol", ["1e-6", "1e-8"])
def test_a_very_stiff_body_moves_as_a_rigid_one(folder, rtol):
    """At 1e-6, the smallest moves onto the constraints of pin and interfaces changed the force of the pin by 400 times its value."""
    flexible = run(
        scene(folder, PIN, f"velocity: [0, {5 * LENGTH / 2}, 0]\n    omega: [0, 0, 5]", "[0, -9.81, 0]", bodies__bar__matrices="stiff.npz", run__duration="0.2",
              bodies__bar__damping="0.1", run__rtol=rtol, run__points="201")
    )  # fmt: skip
    squares = np.array([LENGTH, WIDTH, HEIGHT]) ** 2
    inertia = (MASS / 12 * (squares.sum() - squares)).tolist()
    centre = [LENGTH / 2, WIDTH / 2, HEIGHT / 2]
    path = folder / "rigid.yaml"
    path.write_text(
        f"dimensions: 3\ngravity: [0, -9.81, 0]\nbodies:\n  bar: {{mass: {MASS}, inertia: {inertia}, center_of_mass: {centre}, omega: [0, 0, 5], "
        f"velocity: [0, {5 * LENGTH / 2}, 0], markers: {{a: {{point: [0, 15 mm, 10 mm]}}, b: {{point: [{LENGTH}, 15 mm, 10 mm]}}}}}}\n"
        f"joints: {PIN}\nrun: {{duration: 0.2, points: 201, rtol: 1e-10}}\n"
        "requests: {x: 'dx(bar.b)', y: 'dy(bar.b)'}\n"
    )
    rigid = run(load_scene(path, []))
    for name in ("x", "y"):
        np.testing.assert_allclose(flexible[f"bar.b.{name}"], rigid[name], atol=1e-6)
    for name in ("pin.fx", "pin.fy"):  # vibrations from the start fade within 10 ms
        np.testing.assert_allclose(flexible[name][10:], rigid[name][10:], atol=1e-3 * np.abs(rigid[name]).max())


@pytest.mark.long
@pytest.mark.sampled(4)
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-5, 1e-6])
def test_the_slider_of_a_crank_with_a_very_stiff_rod_is_moved_as_by_a_rigid_one(rtol):
    """The pin's force is mass times acceleration, d2/dt2 (a cos wt + sqrt(b^2 - a^2 sin^2 wt)). bdf was off by 94 to 1047 N of 382 N."""
    crank = Path(__file__).parents[2] / "examples" / "flexible" / "flexible_slider_crank.yaml"
    stiff = read_scene(crank.read_text().replace("E: 200 GPa", "E: 2e8 GPa"), file=crank)
    found = run(
        stiff, solver="bdf", rtol=rtol, duration=0.065
    )  # a last step that happens to be short is off by up to 9 N
    a, b, rate, mass = 0.15, 0.3, 150.0, 0.075552
    sine, cosine = np.sin(rate * found.t), np.cos(rate * found.t)
    root = np.sqrt(b**2 - a**2 * sine**2)
    acceleration = -(a * cosine + a**2 * (cosine**2 - sine**2) / root + (a**2 * sine * cosine) ** 2 / root**3) * rate**2
    late = slice(5, None)  # vibrations from the start have faded
    np.testing.assert_allclose(found["wrist_pin.fx"][late], -mass * acceleration[late], atol=5.0)


def test_a_simulation_and_a_run_have_the_same_reactions(folder):
    """Both project the states of one integrator, which would change the force of the pin by 100 times its value."""
    stiff = scene(folder, PIN, "omega: [0, 0, 5]", "[0, -9.81, 0]", bodies__bar__matrices="stiff.npz", bodies__bar__damping="0.1")  # fmt: skip
    expected = run(stiff, rtol=1e-5, duration=0.2, points=51)
    stepped = simulation(stiff, rtol=1e-5, duration=0.3)
    for t, force in zip(expected.t[1:], expected["pin.fy"][1:], strict=True):
        stepped.step(t - stepped.t)
        if t > 0.01:
            assert stepped["pin.fy"] == pytest.approx(force, abs=1e-2 * np.abs(expected["pin.fy"][3:]).max())


@pytest.mark.long
def test_natural_modes_of_the_clamped_bar_are_those_of_the_reduction(folder):
    body = reduced_body(read_flexible_body(str(folder / "bar.yaml")), folder)
    found = modes(scene(folder, CLAMP))
    np.testing.assert_allclose([mode.natural_frequency for mode in found.modes], body.held_frequencies([0]), rtol=1e-6)


def test_reductions_with_other_types_of_interfaces_differ(folder):
    rigid, average = (
        reduced_body(read_flexible_body(str(folder / "bar.yaml"), [("interfaces.a.type", kind)]), folder)
        for kind in ("rigid", "average")
    )
    assert average.frequencies[0] < (1 - 1e-5) * rigid.frequencies[0]


@pytest.mark.parametrize(
    ("damping", "expected"),
    [
        ("0.02", lambda rate, k: 0.02),
        ("[0.01, 0.03, 0.02]", lambda rate, k: (0.01, 0.03, 0.02)[min(k, 2)]),
        ("{mass: 20/s, stiffness: 1e-6 s}", lambda rate, k: (20 / rate + 1e-6 * rate) / 2),
    ],
)
def test_damping_of_the_free_modes(folder, damping, expected):
    """The same ratio for all modes, one by mode (the last for further ones), and that of Rayleigh."""
    found = modes(scene(folder, bodies__bar__damping=damping)).modes
    elastic = [mode for mode in found if mode.natural_frequency > 1][:6]
    assert len(elastic) == 6
    for k, mode in enumerate(elastic):
        assert mode.damping_ratio == pytest.approx(expected(2 * np.pi * mode.natural_frequency, k), rel=1e-4)


def test_the_clamped_bar_sags_by_its_weight(folder):
    found = equilibrium(scene(folder, CLAMP, gravity="[0, -9.81, 0]"))
    sag = MASS * 9.81 * LENGTH**3 / (8 * E * HEIGHT * WIDTH**3 / 12)
    assert WIDTH / 2 - found.channels["bar.b.y"] == pytest.approx(sag, rel=0.05)  # rigid ends are stiffer than a beam's
    assert found.channels["pin.fy"] == pytest.approx(MASS * 9.81, rel=1e-8)


@pytest.mark.long
def test_the_motion_is_the_same_in_another_frame(folder):
    expected = run(scene(folder, motion=FREE))
    turned = "orientation: {z: [0, 1, 0], x: [0, 0, 1]}\n    position: [3, 4, 5]\n    omega: [30, 50, 200]"
    found = run(scene(folder, motion=f"velocity: [2, 3, 1]\n    {turned}"))
    for k, (own, there) in enumerate(zip("xyz", "zxy", strict=True)):
        np.testing.assert_allclose(found[f"bar.b.{there}"] - (5, 3, 4)[k], expected[f"bar.b.{own}"], atol=1e-8)


STIFFENED = {
    "matrices: bar.npz": "mesh: bar.vtu\n    material: {E: 210 GPa, nu: 0.3, density: 7850 kg/m^3}",
    "length: 1 m": "length: 1 mm", "{group: start}": "{plane: {point: [0, 0, 0], normal: [1, 0, 0]}}",
    "{group: end}": "{plane: {point: [400 mm, 0, 0], normal: [1, 0, 0]}}",
}  # fmt: skip
"""The same body as a mesh, with geometric stiffening."""


def test_the_motion_is_the_same_with_another_basis_of_the_modes(folder):
    """Combinations of modes have coupled stiffness and damping; the body's motion does not depend on them."""
    one = scene(folder, PIN, motion="omega: [3, 5, 20]", gravity="[1, -9.81, 2]", bodies__bar__damping="0.02")
    frame = one.bodies["bar.frame"]
    body, reduced = frame.source[0], reduced_body(*frame.source)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(len(reduced.frequencies),) * 2))[0]
    parts_in_basis = _Parts("bar", body, reduced.in_basis(turn), frame.source[1], None, turn)
    bodies, joints = {**one.bodies, **dict(parts_in_basis.bodies())}, {**one.joints, **dict(parts_in_basis.joints())}
    other = one.model_copy(update={"bodies": bodies, "joints": joints})
    expected, found = run(one), run(other)
    assert np.abs(expected["bar.modes1.x"] - found["bar.modes1.x"]).max() > 1e-8
    for name in ("bar.b.x", "bar.b.y", "bar.b.z", "bar.frame.x", "bar.frame.q1"):
        np.testing.assert_allclose(found[name], expected[name], atol=1e-10)


def test_derivatives_of_the_kernels(folder):
    scene(folder, gravity="[1, 2, -9]")
    text = (folder / "scene.yaml").read_text()
    for old, new in STIFFENED.items():
        text = text.replace(old, new)
    (folder / "mesh.yaml").write_text(text)
    system = compile_model(load_scene(folder / "mesh.yaml", []))
    state, random = State(system), np.random.default_rng(0)
    (group,) = (group for group in system.groups if group.entries["inertia"])
    first = group.index[0, 2 * group.kind.n_bodies]
    numbers = group.numbers[first + int(group.numbers[first]) :]
    n = 3 * (group.kind.n_bodies - 1)
    named = parts(numbers, n)
    for name in ("stiffness", "damping"):
        named[name][:] = random.uniform(1, 2, (n, 1))  # soft: differences keep their digits
    assert named["stretch"] == len(named["Gamma"]) == 6
    for name in ("symmetric", "axial", "of_Z", "T", "Gamma", "static"):  # of one size: all are seen in the matrices
        values = random.standard_normal(named[name].shape)
        pairs = (-2, -1) if name == "Gamma" else (0, 1)
        mirrored = 0.0 if name == "static" else values.swapaxes(*pairs)
        named[name][:] = values - mirrored if name == "of_Z" else values + mirrored  # Z is that of outer products
    named["axial"][:] += named["of_Z"]
    q, u, a = (random.standard_normal(len(each)) for each in (state.q, state.u, state.a))
    q[3:7] /= np.linalg.norm(q[3:7])

    def inertia_force(q, u):
        state.q[:], state.u[:] = q, u
        state.evaluate("motion", 0.0)
        return state.matrix("motion", "inertia") @ a - state.vector("motion", "f")

    others = [each for each in system.groups if each is not group and each.entries["f_u"]]
    for each in others:
        each.numbers[:] = 0.0  # gyroscopic torques and weights
    state.q[:], state.u[:], state.a[:] = q, u, a
    state.evaluate("tangent", 0.0)
    by_q = state.matrix("tangent", "inertia_q") - state.matrix("tangent", "f_q")
    by_u = -state.matrix("tangent", "f_u")
    step = 1e-6
    for x, matrix, force in ((q, by_q, lambda x: inertia_force(x, u)), (u, by_u, lambda x: inertia_force(q, x))):
        differences = [(force(x + step * e) - force(x - step * e)) / (2 * step) for e in np.eye(len(x))]
        np.testing.assert_allclose(matrix, np.array(differences).T, atol=1e-7 * np.abs(matrix).max())


@pytest.mark.long
@pytest.mark.skipif(not (REFERENCES / "g_body.npz").exists(), reason="without the reference data")
def test_leg_tensions_of_the_reference_mechanism(tmp_path):
    data = np.load(REFERENCES / "g_body.npz")
    points = data["ground_points"]
    (tmp_path / "body.npz").write_bytes((REFERENCES / "g_body.npz").read_bytes())
    interfaces = ", ".join(f"p{k}: {{nodes: [{node}], type: point}}" for k, node in enumerate(data["interface_nodes"]))
    legs = [
        f"  leg{k}: {{type: equation, i: body.p{k}, zero: 'dm(body.p{k}, ground.g{k}) - {l0} - {size}*(1 - cos(2*pi*{f}*t))^2/4'}}"
        for k, (l0, size, f) in enumerate(zip(data["leg_l0"], data["leg_A"], data["leg_f"], strict=True))
    ]
    grounds = ", ".join(f"g{k}: {{point: {point.tolist()}}}" for k, point in enumerate(points))
    (tmp_path / "g.yaml").write_text(
        f"dimensions: 3\nmarkers: {{{grounds}}}\nbodies:\n  body: {{type: flexible, matrices: body.npz, units: {{length: 1 m}}, "
        f"interfaces: {{{interfaces}}}, modes: 20}}\njoints:\n" + "\n".join(legs)
        + "\nrun: {duration: 0.2, output: 10 ms, rtol: 1e-6, solver: radau}\n"
    )  # fmt: skip
    solution = run(load_scene(tmp_path / "g.yaml", []))
    reference = np.genfromtxt(REFERENCES / "g_body_ref.csv", delimiter=",", skip_header=2)[:20]
    for k, point in enumerate(points):
        at, force = (np.array([solution[f"{each}{axis}"] for axis in "xyz"]).T for each in (f"body.p{k}.", f"leg{k}.f"))
        along = (point - at) / np.linalg.norm(point - at, axis=1)[:, None]
        np.testing.assert_allclose((force * along).sum(axis=1)[1:], reference[:, 1 + k], atol=0.02)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"dimensions": "2"}, "flexible bodies are in space"),
        ({"bodies__bar__modes": "-1"}, "bodies.bar.modes: found -1"),
        ({"bodies__bar__matrices": "no.npz"}, "bodies.bar: .*no.npz: found no such file"),
        ({"bodies__bar__damping": "-0.1"}, "bodies.bar.damping"),
        ({"bodies__bar__interfaces__a": "{group: x}"}, "bodies.bar: interfaces.a.group: found no group 'x'"),
    ],
)
def test_mistakes_name_the_body(folder, changes, message):
    with pytest.raises(InputError, match=message):
        scene(folder, **changes)


def test_a_fast_rotation_is_noted(folder):
    slow, fast = (run(scene(folder, motion=f"omega: [0, 0, {rate}]", run__duration="1 ms")) for rate in (20, 500))
    assert not any("stiffness" in note for note in slow.notes)
    assert any("'bar': rotation at up to 500 rad/s" in note and "use a mesh" in note for note in fast.notes)
