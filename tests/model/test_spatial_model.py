"""Describing mechanisms in space: orientations, principal axes, markers, and what is refused."""

import itertools

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from scipy.spatial.transform import Rotation

import stiffmbs
from stiffmbs import InputError, spatial
from stiffmbs.elements.spatial.orientation import Orientation, conjugate, from_matrix, matrix, product, rotated
from stiffmbs.reading.marker import MarkerReference

SEQUENCES = ["".join(s) for s in itertools.product("xyz", repeat=3) if s[0] != s[1] != s[2]]
QUARTERS = [*np.eye(4), [0.5, 0.5, 0.5, 0.5], [0, 0.6, 0, 0.8], [np.sqrt(0.5), 0, -np.sqrt(0.5), 0]]
READ = TypeAdapter(Orientation)


def oriented(found):
    """The rotation matrix of what a scene gives as an orientation."""
    return matrix(READ.validate_python(found))


def random_rotations(count=20):
    return Rotation.random(count, random_state=5)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_euler_angles_turn_about_the_bodys_own_axes(sequence):
    for angles in np.random.default_rng(1).uniform(-3, 3, (5, 3)):
        expected = Rotation.from_euler(sequence.upper(), angles).as_matrix()  # upper case: intrinsic
        np.testing.assert_allclose(oriented({"euler": sequence, "angles": list(angles)}), expected, atol=1e-14)


def test_angles_are_read_with_their_units():
    expected = Rotation.from_euler("ZXZ", [30, 45, -60], degrees=True).as_matrix()
    np.testing.assert_allclose(
        oriented({"euler": "zxz", "angles": ["30 deg", "pi/4", "-60 deg"]}), expected, atol=1e-15
    )


def test_quaternions_and_matrices_mean_what_scipy_takes_them_for():
    turns = [*random_rotations(), *(Rotation.from_quat(q, scalar_first=True) for q in QUARTERS)]
    for turn in turns:
        q, A = turn.as_quat(scalar_first=True), turn.as_matrix()
        np.testing.assert_allclose(oriented(list(q)), A, atol=1e-15)
        np.testing.assert_allclose(oriented(A.tolist()), A, atol=1e-15)
        p = from_matrix(A)
        assert min(np.abs(q - p).max(), np.abs(q + p).max()) < 1e-15


def test_products_turns_back_and_turned_vectors():
    one, other = random_rotations(2)
    p, q = (turn.as_quat(scalar_first=True) for turn in (one, other))
    np.testing.assert_allclose(matrix(product(p, q)), (one * other).as_matrix(), atol=1e-15)
    np.testing.assert_allclose(matrix(conjugate(p)), one.inv().as_matrix(), atol=1e-15)
    np.testing.assert_allclose(rotated(p, [1, 2, 3]), one.apply([1, 2, 3]), atol=1e-14)


@pytest.mark.parametrize(("first", "second"), list(itertools.permutations("xyz", 2)))
def test_of_two_axes_the_first_is_exact_and_the_second_in_their_plane(first, second):
    a, b = np.random.default_rng(2).normal(size=(2, 3))
    A = oriented({first: list(a), second: list(b)})
    np.testing.assert_allclose(A @ A.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(A) == pytest.approx(1)
    axis, other = A[:, "xyz".index(first)], A[:, "xyz".index(second)]
    np.testing.assert_allclose(axis, a / np.linalg.norm(a), atol=1e-15)
    assert other @ b > 0
    assert np.cross(a, b) @ other == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("name", "xyz")
@pytest.mark.parametrize("direction", [[0.3, -2, 1], [1, 0, 0], [-1, 0, 0], [0, -1, 0], [0, 0, -5]])
def test_one_axis_goes_its_way_and_the_others_anywhere(name, direction):
    A = oriented({name: direction})
    np.testing.assert_allclose(A[:, "xyz".index(name)], np.array(direction) / np.linalg.norm(direction), atol=1e-15)
    np.testing.assert_allclose(A @ A.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(A) == pytest.approx(1)


def test_an_axis_where_it_is_anyway_turns_nothing():
    for found in ({"z": [0, 0, 2]}, {"x": [1, 0, 0], "y": [3, 1, 0]}, np.eye(3).tolist(), [1, 0, 0, 0]):
        assert READ.validate_python(found) == (1, 0, 0, 0)


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ([1, 0, 0, 1], "found a quaternion of length 1.41421, expected one of length 1"),
        ([1, 0, 0], "in an orientation, expected a list of 3 numbers"),
        ([1, 0], r"found \[1, 0\], expected \[w, x, y, z\], a 3x3 matrix"),
        ([[1, 0, 0], [0, 1, 0], [0, 0, -1]], "left-handed mirror image, expected a rotation"),
        ([[1, 0, 0], [0, 1, 0], [0, 1, 0]], "expected one of unit columns at right angles"),
        ({"euler": "zzx", "angles": [0, 0, 0]}, "found the sequence 'zzx', expected three of x, y, z"),
        ({"euler": "ZXZ", "angles": [0, 0, 0]}, "found the sequence 'ZXZ'"),
        ({"euler": "zxz", "angles": [0, 0]}, r"found \[0, 0\] in an orientation, expected a list of 3"),
        ({"euler": "zxz", "angles": ["1 m", 0, 0]}, "found '1 m', which is in m"),
        ({"z": [0, 0, 0]}, "found the axis z without a length"),
        ({"z": [0, 0, 1], "x": [0, 0, 2]}, "found the axes z and x in one direction"),
        ({"z": [0, 0, 1], "x": [1, 0, 0], "y": [0, 1, 0]}, "found the axes z, x, y, expected one or two"),
        ({"w": [0, 0, 1]}, "expected .*one or two axes such as"),
        ("up", "found 'up', expected"),
        (np.eye(4).tolist(), "found a list, expected a number"),
    ],
)
def test_what_is_no_orientation_is_refused_in_one_sentence(found, words):
    with pytest.raises(ValidationError, match=words):
        READ.validate_python(found)


def random_tensor(rng):
    """An inertia tensor: of points with mass, about their centre."""
    points = rng.normal(size=(5, 3))
    points -= points.mean(axis=0)
    return np.sum([(r @ r) * np.eye(3) - np.outer(r, r) for r in points], axis=0)


def test_principal_axes_make_the_tensor_diagonal():
    rng = np.random.default_rng(3)
    for _ in range(10):
        tensor = random_tensor(rng)
        body = spatial.Body(mass=1, inertia=tensor.tolist())
        R, moments = matrix(body.principal_axes()), body.principal_moments()
        assert np.linalg.det(R) == pytest.approx(1)
        np.testing.assert_allclose(moments, np.linalg.eigvalsh(tensor), rtol=1e-13)
        np.testing.assert_allclose(R @ np.diag(moments) @ R.T, tensor, atol=1e-13)
        assert body.masses() == (1, 1, 1, *moments)


def test_a_diagonal_tensor_keeps_the_bodys_own_axes():
    for inertia in ((3, 1, 2), np.diag([3, 1, 2]).tolist()):
        body = spatial.Body(mass=1, inertia=inertia)
        assert body.principal_axes() == (1, 0, 0, 0)
        assert body.principal_moments() == (3, 1, 2)


@pytest.fixture
def turned():
    """A body whose origin, centre of mass, own axes and principal axes all differ, in a model of its own."""
    rng = np.random.default_rng(4)
    q = random_rotations(3)
    body = spatial.Body(
        mass=2, inertia=random_tensor(rng).tolist(), center_of_mass=tuple(rng.normal(size=3)),
        position=tuple(rng.normal(size=3)), orientation=q[0].as_quat(scalar_first=True),
        velocity=(1, 2, 3), omega=tuple(rng.normal(size=3)),
        markers={"end": {"point": tuple(rng.normal(size=3)), "orientation": q[1].as_quat(scalar_first=True)}},
    )  # fmt: skip
    model = spatial.Model(gravity=(0, 0, -9.81))
    model.add("body", body)
    return body, model.data()


def test_the_solver_starts_from_the_centre_of_mass_in_principal_axes(turned):
    body, _ = turned
    A, R = matrix(body.orientation), matrix(body.principal_axes())
    q, u = np.array(body.coordinates()), np.array(body.rates())
    np.testing.assert_allclose(q[:3], np.array(body.position) + A @ body.center_of_mass, atol=1e-15)
    np.testing.assert_allclose(matrix(q[3:]), A @ R, atol=1e-14)
    np.testing.assert_allclose(u[:3], (1, 2, 3))
    np.testing.assert_allclose(R @ u[3:], body.omega, atol=1e-14)
    momentum = A @ np.array(body.inertia) @ body.omega
    np.testing.assert_allclose(matrix(q[3:]) @ (np.array(body.masses()[3:]) * u[3:]), momentum, atol=1e-13)


def test_a_marker_is_at_one_place_seen_from_the_origin_or_from_the_centre_of_mass(turned):
    body, data = turned
    q = np.array(body.coordinates())
    for marker in (
        spatial.Marker(body="body"),
        MarkerReference(body="body", marker="end"),
        spatial.Marker(body="body", point=(1, -2, 0.5), orientation={"z": (1, 1, 0), "x": (0, 0, 1)}),
    ):
        name, placed = data.carried(marker)
        numbers = np.array(placed.numbers())
        found = data.initial_marker(marker)
        assert name == "body"
        np.testing.assert_allclose(q[:3] + matrix(q[3:]) @ numbers[:3], found.point, atol=1e-14)
        np.testing.assert_allclose(matrix(q[3:]) @ numbers[3:12].reshape(3, 3), found.axes, atol=1e-14)
        np.testing.assert_allclose(data.point(marker), found.point)
    own, A = data.place(MarkerReference(body="body", marker="end")), matrix(body.orientation)
    found = data.initial_marker(spatial.Marker(body="body", marker="end"))
    np.testing.assert_allclose(found.point, np.array(body.position) + A @ own.point, atol=1e-14)
    np.testing.assert_allclose([found.x, found.y, found.z], (A @ matrix(own.orientation)).T, atol=1e-14)


def test_a_model_in_space_has_its_size_from_corner_to_corner():
    model = spatial.Model()
    bar = model.add("bar", spatial.Body(mass=1, inertia=(1, 1, 1), position=(1, 0, 0)))
    model.add("ball", spatial.Spherical(i=bar.at(0, 2, 0), j=spatial.Marker(body="ground", point=(0, 0, 2))))
    assert model.data().size() == pytest.approx(3)
    assert model.data().dimensions == 3


SCENE = """
dimensions: 3
parameters: {L: 2 m}
gravity: [0, 0, -9.81]
bodies:
  link{k}:
    for: k in 1..2
    mass: 1
    inertia: [1, 1, 1]
    position: [k*L, 0, 0]
    markers: {end: {point: [L/2, 0, 0], orientation: {y: [0, 0, 1]}}}
joints:
  pin: {type: revolute, i: link1, j: {body: ground, point: [L, 0, 0]}}
  ball: {type: spherical, i: link1.end, j: {body: link2, point: [-L/2, 0, 0]}}
requests: {stretch: "dx(link2, ground, link1) + link1.wz"}
"""


def test_a_scene_says_that_it_is_in_space():
    scene = stiffmbs.read_scene(SCENE)
    assert scene.dimensions == 3
    assert scene.bodies["link2"].position == (4, 0, 0)
    assert scene.point(scene.joints["ball"].i) == (3, 0, 0)


def test_the_schema_has_both_families():
    import jsonschema
    from ruamel.yaml import YAML

    found = YAML(typ="safe", pure=True).load(SCENE)
    schema = jsonschema.Draft202012Validator(stiffmbs.scene_schema())
    schema.validate(found)
    for wrong in (
        {"dimensions": 2},
        {"gravity": [0, 0]},
        {"dimensions": 3, "bodies": {"b": {"mass": 1, "inertia": 1}}},
    ):
        assert not schema.is_valid(found | wrong)


@pytest.mark.parametrize(
    ("written", "instead", "words"),
    [
        ("dimensions: 3", "dimensions: 4", "line 2, dimensions: found 4, expected 2 or 3"),
        ("dimensions: 3", "", "line 5, dimensions: found none, expected 3 for bodies in space"),
        ("[0, 0, -9.81]", "[0, -9.81]", "gravity.2: found nothing, expected a value"),
        ("[1, 1, 1]", "[1, 1, 3]", "inertia: found the principal moments 1, 1 and 3 kg m.2, expected none greater than"),
        ("[1, 1, 1]", "[1, 0, 1]", "inertia: found a principal moment of 0 kg m.2, expected all three greater than zero"),
        ("[1, 1, 1]", "[1, 1]", "inertia: found 2 numbers, expected Ixx, Iyy, Izz or a 3x3 tensor"),
        ("[1, 1, 1]", "[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]", "found 0.1 in row 1, column 2 and 0 across the diagonal"),
        ("type: revolute", "type: distant", r"found the type 'distant' \(did you mean 'distance'\?\), expected one of .*'revolute'"),
        ("i: link1, j", "i: link3, j", r"joints.pin.i: found the unknown body 'link3' \(did you mean 'link2'\?\), expected link1, link2, ground"),
        ("link1.end", "link1.tip", "joints.ball.i: found 'link1.tip', expected one of its markers .end"),
        ("i: link1, j", "i: {body: link1, orientation: {z: [1, 0, 0]}}, j", "joints.pin: found the z axes .* 90 degrees"),
        ("link1.wz", "link1.omega", "requests.stretch: found 'link1.omega' in .*, expected one of link1.x, .*, link1.wz"),
    ],
)  # fmt: skip
def test_wrong_scenes_are_refused_in_one_sentence(written, instead, words):
    with pytest.raises(InputError, match=words) as raised:
        stiffmbs.read_scene(SCENE.replace(written, instead))
    assert "\n" not in str(raised.value)


def test_arrays_are_as_good_as_lists():
    body = spatial.Body(mass=np.float64(1), inertia=np.eye(3), orientation=np.eye(3), position=np.arange(3))
    assert body == spatial.Body(mass=1, inertia=(1, 1, 1), position=(0, 1, 2))
    mount = spatial.Bushing(i="a", j="b", stiffness=np.diag(np.arange(1, 7)))
    assert mount.stiffness[5][5] == 6
    assert spatial.AppliedForce(i="a", force=np.arange(3)) == spatial.AppliedForce(i="a", force=(0, 1, 2))


@pytest.mark.parametrize("name", [None, 3, ["a"], "two words"])
def test_names_are_words(name):
    model = spatial.Model()
    with pytest.raises(InputError, match="expected letters, digits and _"):
        model.add(name, spatial.Body(mass=1, inertia=(1, 1, 1)))
    with pytest.raises(InputError, match="expected letters, digits and _"):
        model.mark(name, spatial.Marker(body="ground", point=(1, 2, 3)))


def test_space_and_plane_do_not_mix():
    model, plane = spatial.Model(), stiffmbs.Model()
    with pytest.raises(InputError, match=r"a: found .* expected a body, a joint or a force of stiffmbs.spatial"):
        model.add("a", stiffmbs.Body(mass=1, inertia=1))
    model.add("a", spatial.Body(mass=1, inertia=(1, 1, 1)))
    plane.add("a", stiffmbs.Body(mass=1, inertia=1))
    with pytest.raises(
        InputError, match=r"pin: found .* expected a joint or a force whose markers are of stiffmbs.spatial"
    ):
        model.add("pin", stiffmbs.Revolute(i="a", j="ground"))
    with pytest.raises(InputError, match=r"pin: found .* expected a joint or a force"):
        plane.add("pin", spatial.Revolute(i="a", j="ground"))
    with pytest.raises(InputError, match=r"found 'a.angle', expected one of a.x, a.y, a.z, a.q0"):
        model.add("held", spatial.ConstraintEquation(zero="a.angle"))
    with pytest.raises(InputError, match=r"found the measure dz in .* expected one of the plane: dx, dy, dm, az"):
        plane.add("held", stiffmbs.ConstraintEquation(zero="dz(a)"))
    with pytest.raises(InputError, match=r"found 3 markers of dm in .*, expected one or two"):
        model.add("held", spatial.ConstraintEquation(zero="dm(a, ground, a) - 1"))
    with pytest.raises(InputError, match=r"coordinate: found the velocity wx in .* expected positions only"):
        model.add("motor", spatial.Drive(coordinate="wx(a)", position=0))


def test_a_gear_in_space_starts_as_drawn():
    model = spatial.Model()
    for k in (1, 2):
        turned = {"euler": "zxz", "angles": (0.1 * k, 0, 0)}
        model.add(f"wheel{k}", spatial.Body(mass=1, inertia=(1, 1, 1), position=(k, 0, 0), orientation=turned))
        model.add(f"pin{k}", spatial.Revolute(i=f"wheel{k}", j=spatial.Marker(body="ground", point=(k, 0, 0))))
    with pytest.raises(InputError, match=r"rack: found 'pin1' of the type revolute, expected a prismatic joint"):
        model.add("mesh", spatial.RackAndPinion(rack="pin1", pinion="pin2", pitch_radius=1))
    model.add("mesh", spatial.Gear(joint_1="pin1", joint_2="pin2", ratio=0.7))
    assert dict(model.data().elements_at_initial_pose())["mesh"].offset == pytest.approx(0.1 + 0.7 * 0.2)


@pytest.mark.long
@pytest.mark.parametrize("driven", [{"joint": "pin1"}, {"coordinate": "az(wheel1, ground)"}], ids=["joint", "formula"])
def test_gears_and_drives_in_space_turn_over_and_over(driven):
    """A driven wheel turns its neighbour by the ratio of their teeth, over many turns."""
    model, rate, ratio = spatial.Model(), 5.0, 0.7
    for k, inertia in ((1, (1, 1, 2)), (2, ((1, 0.1, 0), (0.1, 2, 0), (0, 0, 3)))):
        model.add(f"wheel{k}", spatial.Body(mass=1, inertia=inertia, position=(k, 0, 0)))
        model.add(f"pin{k}", spatial.Revolute(i=f"wheel{k}", j=spatial.Marker(body="ground", point=(k, 0, 0))))
    model.add("mesh", spatial.Gear(joint_1="pin1", joint_2="pin2", ratio=ratio))
    model.add("motor", spatial.Drive(**driven, position=f"{rate}*t^2/2"))
    model.request("turned", "az(wheel1, ground)")
    solution = stiffmbs.run(model, duration=5.0, rtol=1e-8)
    t = solution.time
    assert rate * t[-1] ** 2 / 2 > 9 * 2 * np.pi
    np.testing.assert_allclose(solution["turned"], rate * t**2 / 2, atol=1e-9)
    np.testing.assert_allclose(solution["wheel1.wz"], rate * t, atol=1e-8)
    np.testing.assert_allclose(solution["wheel2.wz"], -rate * t / ratio, atol=1e-8)
    np.testing.assert_allclose(solution["motor.tz"], rate * (2 + 3 / ratio**2), atol=1e-6)
