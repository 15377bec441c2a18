"""Sections whose shear centre is not the centroid, or whose axes are not principal axes, against closed forms."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

import stiffmbs
from stiffmbs import InputError, read_scene
from stiffmbs.model.beams.section import Angle, Channel, Drawn, Properties

from .scenes import at_rest

E, G, L = 200e9, 80e9, 2.0
U = "{type: u, width: 50 mm, height: 100 mm, flange: 5 mm, web: 4 mm}"
LEGS = "{type: l, width: 50 mm, height: 80 mm, thickness: 5 mm}"
WAYS = pytest.mark.parametrize("interpolation", ["pairs", "spectral"])


def beam(section, loads, interpolation="pairs", n=4, more=""):
    return f"""
dimensions: 3
bodies:
  s: {{type: beam, start: [0, 0, 0], end: [{L}, 0, 0], elements: {n}, interpolation: {interpolation},
       section: {section}, material: {{E: {E}, nu: 0.25, density: 7850}}{more}}}
joints: {{clamp: {{type: fixed, i: s.start, j: ground}}}}
forces: {{{loads}}}
"""


def channel():
    return Channel(width=0.05, height=0.1, flange=0.005, web=0.004).properties(0.25)


def turned(found, node="end"):
    """Rotation vector of a node that is turned by little, from its quaternion."""
    return np.array([2 * found[f"s.{node}.q{k}"] for k in (1, 2, 3)])


@pytest.mark.long
def test_a_channel_that_is_loaded_at_its_centroid_twists():
    """By F e L/(G J), and its shear centre by the deflection of a symmetrical beam."""
    of, F = channel(), 1e-2
    e = of.shear_centre[0]
    found = at_rest(beam(U, f"F: {{type: force, i: s.end, force: [0, 0, {F}]}}"))
    twist = turned(found)[0]
    assert twist == pytest.approx(-F * e * L / (G * of.J), rel=1e-5)
    bending = F * L**3 / (3 * E * of.I2) + F * L / (of.shear3 * G * of.A)
    assert found["s.end.z"] + twist * e == pytest.approx(bending, rel=1e-5)


def test_a_channel_that_is_loaded_at_its_shear_centre_does_not_twist():
    of, F = channel(), 1e-2
    e = of.shear_centre[0]
    found = at_rest(beam(U, f"F: {{type: force, i: {{body: s.end, point: [0, {e!r}, 0]}}, force: [0, 0, {F}]}}"))
    assert abs(turned(found)[0]) < 1e-6 * F * abs(e) * L / (G * of.J)
    bending = F * L**3 / (3 * E * of.I2) + F * L / (of.shear3 * G * of.A)
    assert found["s.end.z"] == pytest.approx(bending, rel=1e-5)


def test_a_taper_interpolates_the_shear_centre():
    """A load at the centroid twists by F/(G J) times the integral of the distance, also from one end with none."""
    J, F = 2e-8, 1e-2
    start, end = (f"{{type: numbers, A: 1e-3, I2: 2e-6, I3: 1e-6, J: {J}, shear_centre: [{y}, 0]}}" for y in (0, -0.03))
    tapered = f"{start}, section_end: {end}"
    found = at_rest(beam(tapered, f"F: {{type: force, i: s.end, force: [0, 0, {F}]}}", n=8))
    assert turned(found)[0] == pytest.approx(F * 0.015 * L / (G * J), rel=1e-4)
    with pytest.raises(InputError, match="found spectral and a section with its shear centre off the centroid"):
        read_scene(beam(tapered, "", "spectral"))


@pytest.mark.long
def test_a_taper_completes_its_sections_before_it_interpolates():
    """I3 and J of one end by default are those of that end, whatever the other end gives."""
    given = "{type: numbers, A: 1e-3, I2: 2e-6, I3: 1e-6, J: 2e-8}"
    short, full = "{type: numbers, A: 1e-3, I2: 1e-6}", "{type: numbers, A: 1e-3, I2: 1e-6, I3: 1e-6, J: 2e-6}"
    load = "F: {type: force, i: s.end, force: [0, 1e-2, 0]}, T: {type: torque, i: s.end, torque: [1e-3, 0, 0]}"
    for tapers in (
        [f"{given}, section_end: {end}" for end in (short, full)],
        [f"{start}, section_end: {given}" for start in (short, full)],
    ):
        found, expected = (at_rest(beam(taper, load, n=4)) for taper in tapers)
        assert found["s.end.y"] == pytest.approx(expected["s.end.y"], rel=1e-12)
        assert turned(found)[0] == pytest.approx(turned(expected)[0], rel=1e-12)


@pytest.mark.long
def test_an_angle_bends_obliquely():
    """Its end moves by F L^3/(3 E) I^-1, and the shear, in both directions (Timoshenko)."""
    of = Angle(width=0.05, height=0.08, thickness=0.005).properties(0.25)
    (y, z), F = of.shear_centre, 1e-2
    load = f"F: {{type: force, i: {{body: s.end, point: [0, {y!r}, {z!r}]}}, force: [0, 0, {F}]}}"
    found = at_rest(beam(LEGS, load))
    D = of.I2 * of.I3 - of.I23**2
    bending = F * L**3 / (3 * E) * np.array([-of.I23, of.I3]) / D
    shear = F * L / (G * of.A) * np.array([of.shear23, 1 / of.shear3])
    assert [found["s.end.y"], found["s.end.z"]] == pytest.approx(bending + shear, rel=1e-5)
    assert abs(bending[0]) > 0.3 * bending[1]


def test_a_channel_has_its_shear_centre_in_front_of_its_web():
    """At 3 b^2 t/(6 b t + h w) from the middle of the web, with lengths between middle lines (Timoshenko)."""
    for width, height, flange, web in ((0.05, 0.1, 1e-4, 2e-4), (0.08, 0.03, 3e-4, 1e-4)):
        of = Channel(width=width, height=height, flange=flange, web=web).properties(0.3)
        b, h = width - web / 2, height - flange
        e = 3 * b**2 * flange / (6 * b * flange + h * web)
        centroid = b**2 * flange / (2 * b * flange + h * web)
        assert of.shear_centre == pytest.approx((-e - centroid, 0), abs=1e-6)
        assert pytest.approx((2 * b * flange**3 + h * web**3) / 3) == of.J


def test_an_angle_of_equal_legs_has_the_shear_centre_at_its_corner_and_five_sixths_of_each_leg():
    b, t = 0.05, 1e-4
    of = Angle(width=b, height=b, thickness=t).properties(0.3)
    assert of.shear_centre == pytest.approx((-b / 4, -b / 4), abs=t)
    assert pytest.approx(np.array([5, 5, -3]) * b**3 * t / 24, rel=1e-2) == (of.I2, of.I3, of.I23)
    assert (of.shear2, of.shear3, of.shear23) == pytest.approx((5 / 12, 5 / 12, 0), rel=1e-3, abs=1e-3)


@pytest.mark.long
def test_drawn_profiles_have_the_constants_of_thin_walls():
    pytest.importorskip("sectionproperties")
    b, h, t = 0.05, 0.08, 0.0025
    legs = ((0, 0), (b, 0), (b, t), (t, t), (t, h), (0, h))
    outline = ((0, 0), (b, 0), (b, t), (t, t), (t, h - t), (b, h - t), (b, h), (0, h))
    for points, thin in (
        (legs, Angle(width=b, height=h, thickness=t)), (outline, Channel(width=b, height=h, flange=t, web=t))
    ):  # fmt: skip
        drawn, plain = Drawn(points=points).properties(0), thin.properties(0)
        for name in ("A", "I2", "I3", "I23"):
            assert getattr(drawn, name) == pytest.approx(getattr(plain, name), rel=1e-9, abs=1e-15)
        assert pytest.approx(plain.J, rel=2e-2) == drawn.J
        assert drawn.shear_centre == pytest.approx(plain.shear_centre, abs=2e-4)
        assert drawn.wagner == pytest.approx(plain.wagner, abs=1e-3)
        found = np.linalg.inv(drawn.stiffness(E, G))[:4, :4]
        expected = np.linalg.inv(plain.stiffness(E, G))[:4, :4]
        assert found == pytest.approx(expected, rel=5e-2, abs=1e-2 * np.max(expected[:3, :3]))


def random_section(rng, interpolation):
    """Constants of a section with a random shear centre and product of inertia, as text and as stiffness."""
    A, I2, I3, J = (rng.uniform([0.5, 0.1, 0.1, 0.1], [2, 3, 3, 3]) * [1e-3, 1e-6, 1e-6, 1e-7]).tolist()
    I23 = rng.uniform(-0.9, 0.9) * math.sqrt(I2 * I3)
    shear2, shear3, y, z = rng.uniform([0.3, 0.3, -0.05, -0.05], [1, 1, 0.05, 0.05]).tolist()
    if interpolation == "spectral":
        y = z = 0.0
    text = (
        f"{{type: numbers, A: {A!r}, I2: {I2!r}, I3: {I3!r}, J: {J!r}, shear2: {shear2!r}, shear3: {shear3!r}, "
        f"I23: {I23!r}, shear_centre: [{y!r}, {z!r}]}}"
    )
    return text, (A, I2, I3, J, I23, shear2, shear3, y, z)


def by_superposition(constants, force, torque, at):
    """Displacement of the point `at` of the end section and its rotation, from first-order theory.

    Bending about principal axes, shear and torsion about the shear centre are added: no matrix of the package.
    """
    A, I2, I3, J, I23, shear2, shear3, y, z = constants
    (Fx, F2, F3), (M1, M2, M3) = force, torque
    centre = np.array([0, y, z])
    M1 = M1 + F3 * (at[2 - 1] - y) - F2 * (at[2] - z)
    M2, M3 = M2 + Fx * at[2], M3 - Fx * at[1]
    angle = math.atan2(-2 * I23, I2 - I3) / 2
    c, s = math.cos(angle), math.sin(angle)
    I_first = I2 * c * c + I3 * s * s - 2 * I23 * s * c
    I_second = I2 * s * s + I3 * c * c + 2 * I23 * s * c
    first, second = np.array([c, s]), np.array([-s, c])
    F, M = np.array([F2, F3]), np.array([M2, M3])
    shift, bend = np.zeros(2), np.zeros(2)
    for along, across, moment, sign in ((first, second, I_first, 1), (second, first, I_second, -1)):
        P, m = F @ across, M @ along  # bending about `along` by a force along `across`
        shift += across * (P * L**3 / (3 * E * moment) - sign * m * L**2 / (2 * E * moment))
        bend += along * (-sign * P * L**2 / (2 * E * moment) + m * L / (E * moment))
    shift += F * L / (G * A) / np.array([shear2, shear3])
    rotation = np.array([M1 * L / (G * J), *bend])
    # The centroid stretches, the shear centre shears; every other point follows the rotation.
    axial = Fx * L / (E * A)
    moved = np.array([0, *shift]) + np.cross([rotation[0], 0, 0], np.array(at) - centre)
    moved[0] = axial + np.cross(rotation, at)[0]
    return moved, rotation


@pytest.mark.long
@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", range(6))
@WAYS
def test_random_sections_under_random_loads(seed, interpolation):
    """Both kinds of elements are exact for small loads at the end."""
    rng = np.random.default_rng(seed)
    text, constants = random_section(rng, interpolation)
    force, torque = rng.normal(size=3) * 0.1, rng.normal(size=3) * 0.01
    at = np.array([0, *rng.uniform(-0.05, 0.05, 2)])
    loads = (
        f"F: {{type: force, i: {{body: s.end, point: {at.tolist()}}}, force: {force.tolist()}}}, "
        f"M: {{type: torque, i: s.end, torque: {torque.tolist()}}}"
    )
    found = at_rest(beam(text, loads, interpolation, n=3))
    moved, rotation = by_superposition(constants, force, torque, at)
    assert turned(found) == pytest.approx(rotation, rel=1e-4, abs=1e-4 * np.max(np.abs(rotation)))
    place = np.array([found[f"s.end.{axis}"] for axis in "xyz"]) - [L, 0, 0] + np.cross(turned(found), at)
    assert place == pytest.approx(moved, rel=1e-4, abs=1e-4 * np.max(np.abs(moved)))


def test_the_natural_frequencies_of_an_angle_are_those_of_its_principal_axes():
    """First frequency of each plane, 1.8751^2 sqrt(E I/(m L^4)), with the shear centre at the centroid."""
    A, I2, I3, I23 = 1e-3, 3e-7, 1e-7, 8e-8
    section = f"{{type: numbers, A: {A}, I2: {I2}, I3: {I3}, J: 1e-6, I23: {I23}}}"
    found = [mode.frequency for mode in stiffmbs.modes(read_scene(beam(section, "", "spectral", n=8))).modes]
    principal = np.linalg.eigvalsh([[I2, -I23], [-I23, I3]])
    expected = 1.87510407**2 * np.sqrt(E * principal / (7850 * A * L**4)) / math.tau
    assert found[:2] == pytest.approx(expected, rel=2e-3)


def test_elements_of_a_channel_twist_to_a_helix_and_stay_straight_under_tension():
    """Torsion about the shear centre bends the beam to a helix (Wagner), and tension of many times 12 EI/L^2 folds no element."""
    of = channel()
    y = of.shear_centre[0]
    torsion = at_rest(beam(U, "M: {type: torque, i: s.end, torque: [10, 0, 0]}", n=2))
    twist = 2 * math.asin(torsion["s.end.q1"])
    k = 10 / (G * of.J)
    radius = (of.I2 + of.I3) / of.A + y * y
    stretched, bent = 1 - radius * k**2 / 2, -of.wagner[1] * k**2 / 2  # by torsion alone: n1 = m3 = 0
    helix = expm(L * np.array([[0, -bent, 0, stretched], [bent, 0, -k, 0], [0, k, 0, -y * k], [0, 0, 0, 0]]))
    assert twist == pytest.approx(k * L, rel=1e-3)
    assert [torsion[f"s.end.{axis}"] for axis in "xyz"] == pytest.approx(helix[:3, 3], rel=1e-3)
    pull, shear = E * of.A / 100, 1.0
    assert pull > 3 * 12 * E * of.I3 / (L / 2) ** 2
    found = at_rest(beam(U, f"F: {{type: force, i: s.end, force: [{pull!r}, {shear}, 0]}}", n=2))
    k = math.sqrt(pull / (E * of.I3))
    assert found["s.end.x"] == pytest.approx(1.01 * L, rel=1e-6)
    assert found["s.end.y"] == pytest.approx(shear / pull * (L - math.tanh(k * L) / k), rel=0.1)


ELEMENT = """
dimensions: 3
bodies: {b: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
forces:
  beam: {type: exact_beam, i: b, j: ground, length: 1, stiffness: %s, %s}
  T: {type: torque, i: b, torque: [1, 0, 0]}
"""


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize(
    ("fields", "shear_centre", "wagner"),
    [
        ("wagner: [0, 0.5, 0.3]", (0, 0), (0.5, 0.3)),
        ("wagner: [0, 0.5, 0.3], bowing: [1.2, 1.2]", (0, 0), (0.5, 0.3)),
        ("shear_centre: [0, 0.1, 0.2]", (0.1, 0.2), (0, 0)),
        ("shear_centre: [0, 0.1, 0.2], wagner: [0, 0.5, 0.3], bowing: [0, 0]", (0.1, 0.2), (0.5, 0.3)),
        ("bowing: [1.2, 1.2]", None, None),
    ],
)  # fmt: skip
def test_an_element_is_a_helix_under_torsion_whichever_fields_are_given(fields, shear_centre, wagner):
    """Its strains follow from no axial force and no moments of bending, and its end from the exponential map.

    The tilt of the end is a moment of bending of about 0.01 N m, which bends the element by 1e-5.
    """
    found = at_rest(ELEMENT % ("[3e4, 2e4, 1.5e4, 5, 800, 900]", fields))
    k, stretched, (about_2, about_3) = 0.2, 1.0, np.zeros(2)
    if shear_centre is not None:
        stretched -= (1700 / 3e4 + np.square(shear_centre).sum()) * k**2 / 2
        about_2, about_3 = -np.array(wagner) * k**2 / 2
    end = expm(np.array([[0, -about_3, about_2, stretched], [about_3, 0, -k, 0], [-about_2, k, 0, 0], [0, 0, 0, 0]]))
    assert [found[f"b.{axis}"] for axis in "xyz"] == pytest.approx(end[:3, 3], abs=2e-5)


@pytest.mark.parametrize(
    ("stiffness", "fields", "expected"),
    [
        ("[0, 200, 150, 5, 8, 9]", "shear_centre: [0, 0, 0]", "stiffness: found no EA, expected it with shear_centre or wagner"),
        ("[300, 200, 150, 5, 8, 0]", "wagner: [0, 1, 1]", "stiffness: found no EI3, expected it with shear_centre or wagner"),
    ],
)  # fmt: skip
def test_an_element_refuses_what_its_stretch_by_torsion_cannot_use(stiffness, fields, expected):
    with pytest.raises(InputError) as found:
        read_scene(ELEMENT % (stiffness, fields))
    assert expected in str(found.value)


def test_a_column_of_a_channel_buckles_by_bending_and_torsion():
    """At the smaller root of r^2 (N2 - N) (N1 - N) = N^2 y^2, with N2 = pi^2 E I2/(4 L^2) and N1 = G J/r^2 (Vlasov)."""
    section = "{type: numbers, A: 1e-3, I2: 3e-7, I3: 2e-6, J: 4e-9, shear_centre: [-0.03, 0]}"
    r2, y = 2.3e-3 + 9e-4, -0.03
    N2, N1 = math.pi**2 * E * 3e-7 / (4 * L**2), G * 4e-9 / r2
    critical = min(np.roots([r2 - y * y, -r2 * (N1 + N2), r2 * N1 * N2]).tolist())
    assert critical < 0.9 * min(N1, N2)
    shares, squares = (0.98, 0.99), []
    for share in shares:
        scene = read_scene(beam(section, f"N: {{type: force, i: s.end, force: [{-share * critical!r}, 0, 0]}}", n=8))
        rest = stiffmbs.equilibrium(scene)
        squares.append(stiffmbs.modes(scene, start_from=rest.solution).modes[0].frequency ** 2)
    slope = (squares[1] - squares[0]) / (shares[1] - shares[0])
    assert shares[1] - squares[1] / slope == pytest.approx(1, abs=3e-3)


def test_a_mirrored_section_moves_as_the_mirror_image():
    load = "F: {type: force, i: s.end, force: [0, %s, 300]}"
    text = (
        "{type: numbers, A: 1e-3, I2: 2e-6, I3: 1e-6, J: 2e-8, I23: %s, shear_centre: [%s, 0.01], wagner: [0.02, %s]}"
    )
    one = at_rest(beam(text % (5e-7, -0.03, 0.05), load % 100))
    other = at_rest(beam(text % (-5e-7, 0.03, -0.05), load % -100))
    for axis, sign in (("x", 1), ("y", -1), ("z", 1), ("q1", -1), ("q2", 1), ("q3", -1)):
        assert one[f"s.end.{axis}"] == pytest.approx(sign * other[f"s.end.{axis}"], rel=1e-9)


@pytest.mark.parametrize(
    ("section", "expected"),
    [
        (U, "bodies.s.section: found a shear centre 0.0324 m from the plane, expected it in the plane"),
        (LEGS, "bodies.s.section: found principal axes at "),
        ("{type: numbers, A: 1e-3, I2: 1e-6, I23: 2e-6}", "found 2e-06 m^4, expected less than the root of I2 I3"),
        ("{type: u, width: 50 mm, height: 9 mm, flange: 5 mm, web: 4 mm}", "expected less than half the height"),
        ("{type: l, width: 50 mm, height: 5 mm, thickness: 5 mm}", "expected less than the legs of 0.05 and 0.005 m"),
    ],
)  # fmt: skip
def test_sections_that_leave_the_plane_are_refused_in_it(section, expected):
    with pytest.raises(InputError) as found:
        read_scene(
            f"bodies: {{s: {{type: beam, start: [0, 0], end: [1, 0], section: {section}, elements: 2, material: {{E: 1e9, density: 1}}}}}}"
        )
    assert expected in str(found.value)


def test_a_shear_centre_off_the_centroid_needs_pairs():
    with pytest.raises(InputError, match="found spectral and a section with its shear centre off the centroid"):
        read_scene(beam(U, "", "spectral"))


def test_a_section_leaves_the_plane_from_a_product_of_inertia_and_an_offset_on():
    """A product of 1e-6 of the second moment, and a shear centre at 0.01 of the root of the area, are the limits."""
    for within, beyond in (({"I23": 0.7e-6}, {"I23": 1.4e-6}), ({"y": 0.007}, {"y": 0.014})):
        for values, leaves in ((within, False), (beyond, True)):
            of = Properties(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, values.get("I23", 0.0), (values.get("y", 0.0), 0.0))
            assert bool(of.leaves_plane()) == leaves


def fibres(rectangles, centre):
    """Wagner's coefficients by a sum over many fibres, with the shear centre from the origin of the rectangles."""
    points, weights = [], []
    for x0, x1, y0, y1 in rectangles:
        x, y = (low + (high - low) * (np.arange(400) + 0.5) / 400 for low, high in ((x0, x1), (y0, y1)))
        points.append(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
        weights.append(np.full(len(points[-1]), (x1 - x0) * (y1 - y0) / 400**2))
    x, dA = np.concatenate(points), np.concatenate(weights)
    stretch = ((x - centre) ** 2).sum(axis=1) / 2
    modes = np.column_stack([np.ones(len(x)), x[:, 1], -x[:, 0]])  # axial strain and the curvatures about axes 2 and 3
    return 2 * np.linalg.solve(modes.T @ (dA[:, None] * modes), modes.T @ (dA * stretch))[1:]


@pytest.mark.parametrize(
    ("section", "rectangles"),
    [
        (Channel(width=0.05, height=0.1, flange=0.005, web=0.004), [(0, 0.05, 0, 0.005), (0, 0.004, 0.005, 0.095), (0, 0.05, 0.095, 0.1)]),
        (Angle(width=0.05, height=0.08, thickness=0.005), [(0, 0.05, 0, 0.005), (0, 0.005, 0.005, 0.08)]),
    ],
)  # fmt: skip
def test_the_part_of_the_stretch_by_torsion_that_bends_the_section(section, rectangles):
    of = section.properties(0.3)
    areas = [(x1 - x0) * (y1 - y0) for x0, x1, y0, y1 in rectangles]
    centroid = np.average([((x0 + x1) / 2, (y0 + y1) / 2) for x0, x1, y0, y1 in rectangles], axis=0, weights=areas)
    assert of.wagner == pytest.approx(fibres(rectangles, centroid + of.shear_centre), rel=1e-4, abs=1e-7)


@pytest.mark.long
@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("outline", "hole", "rectangles"),
    [
        (((0, 0), (5, 0), (5, 2), (2, 2), (2, 8), (0, 8)), (), [(0, 5, 0, 2), (0, 2, 2, 8)]),
        (((0, 0), (5, 0), (5, 2), (2, 2), (2, 8), (5, 8), (5, 10), (0, 10)), (), [(0, 5, 0, 2), (0, 2, 2, 8), (0, 5, 8, 10)]),
        (
            ((0, 0), (6, 0), (6, 9), (0, 9)), ((1, 1), (3, 1), (3, 6), (1, 6)),
            [(0, 6, 0, 1), (0, 1, 1, 6), (3, 6, 1, 6), (0, 6, 6, 9)],
        ),
    ],
    ids=["l", "u", "hole"],
)  # fmt: skip
@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1)])
def test_the_coefficients_of_drawn_sections_are_those_of_their_fibres(outline, hole, rectangles, signs):
    """A mirrored section has its outline clockwise."""
    pytest.importorskip("sectionproperties")
    scale = 0.01 * np.array(signs)
    holes = [(np.array(hole) * scale).tolist()] if hole else []
    of = Drawn(points=(np.array(outline) * scale).tolist(), holes=holes).properties(0)
    areas = [
        np.concatenate([np.sort(np.array(one[k : k + 2]) * s) for k, s in ((0, scale[0]), (2, scale[1]))])
        for one in rectangles
    ]
    weights = [(x1 - x0) * (y1 - y0) for x0, x1, y0, y1 in areas]
    centroid = np.average([((x0 + x1) / 2, (y0 + y1) / 2) for x0, x1, y0, y1 in areas], axis=0, weights=weights)
    assert of.wagner == pytest.approx(fibres(areas, centroid + of.shear_centre), rel=1e-4, abs=1e-7)
    assert np.linalg.norm(of.wagner) > 1e-3


def test_a_thin_angle_of_equal_legs_has_the_coefficient_of_its_closed_form():
    """Root of two times the leg, for bending in the plane of symmetry."""
    of = Angle(width=1.0, height=1.0, thickness=1e-4).properties(0.3)
    assert np.linalg.norm(of.wagner) == pytest.approx(math.sqrt(2), rel=1e-3)
    assert of.wagner[0] == pytest.approx(-of.wagner[1], rel=1e-9)  # about the line across the plane of symmetry


@pytest.mark.long
@pytest.mark.sampled(4)
@pytest.mark.parametrize(("sign", "wagner", "z"), [(1, 0.08, 0.0), (-1, 0.08, 0.0), (1, -0.05, 0.03), (1, 0.0, 0.03)])
def test_a_beam_of_one_symmetry_buckles_sideways_under_a_moment(sign, wagner, z):
    """M^2 = N (G J + w M) with N = pi^2 E I3/L^2: Trahair (1993), sec. 17.4, without warping, between fork supports."""
    I3, J = 2e-8, 4e-9
    N = math.pi**2 * E * I3 / L**2
    roots = np.roots([1, -N * wagner, -N * G * J]).tolist()
    critical = next(root for root in roots if sign * root > 0)
    section = f"{{type: numbers, A: 1e-2, I2: 1e-4, I3: {I3}, J: {J}, shear_centre: [0, {z}], wagner: [{wagner}, 0]}}"
    shares, squares = (0.99, 0.995), []
    for share in shares:
        M = share * critical
        text = f"""
dimensions: 3
bodies: {{s: {{type: beam, start: [0, 0, 0], end: [{L}, 0, 0], elements: 32, section: {section}, material: {{E: {E}, nu: 0.25, density: 7850}}}}}}
joints:
  pin: {{type: spherical, i: s.start, j: ground}}
  line: {{type: point_on_line, i: s.end, j: {{body: ground, orientation: {{z: [1, 0, 0]}}}}}}
  fork_a: {{type: perpendicular, i: {{body: s.start, orientation: {{z: [0, 1, 0]}}}}, j: ground}}
  fork_b: {{type: perpendicular, i: {{body: s.end, orientation: {{z: [0, 1, 0]}}}}, j: ground}}
forces: {{a: {{type: torque, i: s.start, torque: [0, {-M!r}, 0]}}, b: {{type: torque, i: s.end, torque: [0, {M!r}, 0]}}}}
"""
        scene = read_scene(text)
        rest = stiffmbs.equilibrium(scene)
        squares.append(stiffmbs.modes(scene, start_from=rest.solution).modes[0].frequency ** 2)
    slope = (squares[1] - squares[0]) / (shares[1] - shares[0])
    assert shares[1] - squares[1] / slope == pytest.approx(1, abs=3e-3)
