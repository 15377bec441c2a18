"""Modes over a parameter: closed forms of rigid rotors, published frequencies of an elastic one, and the command."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import AssemblyError, InputError
from stiffmbs.linear_analysis.branches import whirl

MASS, POLAR, ACROSS = 10.0, 0.9, 0.5
"""Mass, kg, and moments of inertia about the axis and across it, kg m^2, of a rigid rotor."""
STIFFNESS, ARM = 2e5, 0.35
"""Stiffness of each bearing, N/m, and its distance from the centre of mass, m."""

RIGID = """
name: Rigid rotor
dimensions: 3
gravity: [0, 0, 0]
parameters: {spin: 0 rad/s, ce: 0 N s/m, ci: 0 N s/m, k: 2e5 N/m, a: 0.35 m}
bodies:
  rotor: {mass: 10, inertia: [0.9, 0.5, 0.5], omega: [spin, 0, 0], markers: {left: {point: [-a, 0, 0]}, right: {point: [a, 0, 0]}}}
forces:
  left: {type: bushing, i: rotor.left, j: {body: ground, point: [-a, 0, 0]}, stiffness: [1e3, k, k, 0, 0, 0], damping: [0, 0, 0, 0, 0, 0]}
  right: {type: bushing, i: rotor.right, j: {body: ground, point: [a, 0, 0]}, stiffness: [1e3, k, k, 0, 0, 0], damping: [0, 0, 0, 0, 0, 0]}
  air: {type: force, i: rotor, force: [0, -ce*rotor.vy - ci*(rotor.vy + spin*rotor.z), -ce*rotor.vz - ci*(rotor.vz - spin*rotor.y)]}
"""


@pytest.fixture
def rigid(tmp_path):
    path = tmp_path / "rigid.yaml"
    path.write_text(RIGID)
    return path


def tilts(speeds):
    """Return angular frequencies of forward and backward tilt, J t'' - i Jp W t' + k t = 0, rad/s, one row for each."""
    half = POLAR * speeds / (2 * ACROSS)
    root = np.sqrt(half**2 + 2 * STIFFNESS * ARM**2 / ACROSS)
    return np.array([root + half, root - half])


def test_a_rigid_rotor_has_the_modes_and_critical_speeds_of_its_closed_form(rigid):
    """The translation, 200 rad/s, crosses the backward tilt, from 313 rad/s on, at 290 rad/s: shapes tell the branches apart."""
    found = stiffmbs.campbell(rigid, "spin", "0:600 rad/s:25")
    first = np.round([2 * np.pi * branch.frequencies[0] for branch in found.branches])
    still = np.full(len(found.values), np.sqrt(2 * STIFFNESS / MASS))  # a double eigenvalue: any direction of whirl
    for k in np.flatnonzero(first == 200):
        np.testing.assert_allclose(2 * np.pi * found.branches[k].frequencies, still, rtol=1e-7)
    tilting = [found.branches[k] for k in np.flatnonzero(first == 313)]
    one, other = sorted(tilting, key=lambda branch: -branch.frequencies[-1])
    for branch, way, tilt in zip((one, other), (1.0, -1.0), tilts(found.values), strict=True):
        np.testing.assert_allclose(2 * np.pi * branch.frequencies, tilt, rtol=1e-7)
        np.testing.assert_allclose(branch.whirl[1:], way, rtol=1e-7)
    of_tilt = np.sqrt(2 * STIFFNESS * ARM**2 / (ACROSS + POLAR))  # a forward tilt of a disc meets no order
    speeds = [np.sqrt(2e3 / MASS), of_tilt, still[0], still[0]]  # the first: along the axis
    assert [each.value for each in found.critical()] == pytest.approx(sorted(speeds), rel=1e-5)
    assert found.critical()[1].whirl == pytest.approx(-1.0)


def test_internal_damping_makes_a_rotor_unstable_above_its_limit(rigid):
    """Rotating damping drives the forward whirl from W = w (1 + ce/ci) on (Smith, Proc. R. Soc. A 142, 1933)."""
    changes = [("ce", "30"), ("ci", "20")]
    found = stiffmbs.campbell(rigid, "spin", "0:900 rad/s:19", changes=changes)
    (limit,) = found.limits()
    assert limit.value == pytest.approx(np.sqrt(2 * STIFFNESS / MASS) * 2.5, rel=1e-5)
    assert limit.growing
    assert limit.whirl == pytest.approx(1.0, abs=1e-3)
    assert "stable below:" in str(found)


ELASTIC = """
name: Rotor with two discs
dimensions: 3
gravity: [0, 0, 0]
parameters: {spin: 0, ky: 1e6, c: 0, rho: 7810, n: 24}
bodies:
  shaft:
    type: beam
    start: [0, 0, 0]
    end: [1.5, 0, 0]
    elements: n
    stations: {one: 0.5, two: 1.0}
    section: {type: circle, diameter: 50 mm}
    material: {E: 2.11e11, nu: 0.29926, density: 7810}
    omega: [spin, 0, 0]
"""
DISC = """
  {name}:
    mass: rho*pi/4*({D}^2 - 0.05^2)*0.07
    inertia: [rho*pi/32*({D}^4 - 0.05^4)*0.07, {across}, {across}]
    position: [{x}, 0, 0]
    omega: [spin, 0, 0]
"""
BEARINGS = """
joints:
  seat1: {type: fixed, i: one, j: shaft.one}
  seat2: {type: fixed, i: two, j: shaft.two}
forces:
  left: {type: force, i: shaft.start, force: [0, -ky*shaft.start.y - c*shaft.start.vy, -1e6*shaft.start.z - c*shaft.start.vz]}
  right: {type: force, i: shaft.end, force: [0, -ky*shaft.end.y - c*shaft.end.vy, -1e6*shaft.end.z - c*shaft.end.vz]}
"""


def elastic(path):
    """Write the rotor of example 5.9.1 of Friswell et al., Dynamics of Rotating Machines, Cambridge University Press, 2010."""
    discs = ""
    for name, diameter, x in (("one", 0.28, 0.5), ("two", 0.35, 1.0)):
        across = f"rho*pi/64*({diameter}^4 - 0.05^4)*0.07 + rho*pi/4*({diameter}^2 - 0.05^2)*0.07^3/12"
        discs += DISC.format(name=name, D=diameter, x=x, across=across)
    path.write_text(ELASTIC + discs + BEARINGS)
    return path


SPEED = 4000 * np.pi / 30
PUBLISHED = {
    (): ((86.658, 86.658, 274.307, 274.307, 716.565, 716.565), (85.3894, 87.7958, 251.7805, 294.7059, 600.0818, 826.659)),
    (("ky", "0.8e6"),): ((82.653, 86.658, 254.516, 274.308, 679.32, 716.59), (82.3254, 86.8636, 239.6391, 287.2434, 583.407, 806.548)),
    (("c", "3e3"),): ((87.2578, 87.2578, 292.4163, 292.4163), (85.9657, 88.4146, 263.7825, 318.2256)),
}  # fmt: skip
"""Damped frequencies at rest and at 4000 rpm, rad/s, without torsion, by ROSS 2.3 (Timoshenko elements, 12 to 48)."""


@pytest.mark.parametrize("changes", PUBLISHED)
def test_an_elastic_rotor_has_the_published_frequencies(tmp_path, changes):
    found = stiffmbs.campbell(elastic(tmp_path / "rotor.yaml"), "spin", [0.0, SPEED / 2, SPEED], changes=changes)
    for column, published in zip((0, 2), PUBLISHED[changes], strict=True):
        values = 2 * np.pi * np.sort([branch.frequencies[column] for branch in found.branches])
        values = values[(values > 1.0) & (np.abs(values - 650.4) > 0.1)][: len(published)]  # without torsion
        np.testing.assert_allclose(values, published, rtol=2e-4)


def test_branches_do_not_depend_on_the_number_of_values(tmp_path):
    path = elastic(tmp_path / "rotor.yaml")
    coarse, fine = (
        stiffmbs.campbell(path, "spin", f"0:1200:{count}", changes=[("n", "6"), ("ky", "0.9e6")]) for count in (7, 25)
    )
    for one, other in zip(coarse.branches[:14], fine.branches[:14], strict=True):
        np.testing.assert_allclose(one.frequencies, other.frequencies[::4], rtol=1e-6, atol=1e-6)
    values = [[each.value for each in found.critical(1.0)] for found in (coarse, fine)]
    assert values[0] == pytest.approx(values[1], rel=1e-4)


@pytest.mark.parametrize(
    "move, found", [((0, 1, -1j), 1.0), ((0, 1, 1j), -1.0), ((0, 1, 0), 0.0), ((1, 0, 0), 0.0), ((0, 2, -1j), 0.8)]
)
def test_whirl_is_the_direction_of_the_orbit(move, found):
    velocities, scale = np.array([0, 0, 0, 50.0, 0, 0]), np.ones(6)
    assert whirl(np.array([*move, 0, 0, 0], dtype=complex), velocities, scale, np.ones(1)) == pytest.approx(found)
    assert np.isnan(whirl(np.array([*move, 0, 0, 0], dtype=complex), 0 * velocities, scale, np.ones(1)))


def test_a_value_without_modes_is_left_out_with_a_note(rigid):
    def model(value):
        if value == 100.0:
            raise AssemblyError("no such pose")
        return stiffmbs.load_scene(rigid, [("spin", f"{value}")])

    found = stiffmbs.campbell(model, "spin", [0.0, 100.0, 200.0, 300.0])
    assert found.values.tolist() == [0.0, 200.0, 300.0]
    assert found.notes == ("no modes at spin = 100: no such pose",)


def test_modes_of_other_structures_begin_new_branches(rigid):
    found = stiffmbs.campbell(elastic(rigid.parent / "rotor.yaml"), "n", [3, 4])
    first = [branch for branch in found.branches if not np.isnan(branch.frequencies[0])]
    assert len(first) < len(found.branches)
    assert all(np.isnan(branch.frequencies[1]) for branch in first)


def test_the_command_prints_and_writes(rigid, tmp_path):
    asked = ["modes", str(rigid), "--over", "spin=0:300 rad/s:7"]
    printed = CliRunner().invoke(main, [*asked, "-o", str(tmp_path / "found.csv")])
    assert printed.exit_code == 0, printed.output
    assert "critical speeds, order 1:" in printed.output
    assert "187.083 rad/s  mode 6, 29.7752 Hz, backward whirl" in printed.output
    head, first, *_ = (tmp_path / "found.csv").read_text().splitlines()
    assert head.startswith("spin [rad/s],mode 1 frequency [Hz]")
    assert len(first.split(",")) == 1 + 3 * 6
    drawn = CliRunner().invoke(main, [*asked, "--order", "2", "--json", "-o", str(tmp_path / "found.svg")])
    found = json.loads(drawn.output)
    assert list(found["critical"]) == ["2"]
    assert found["values"] == pytest.approx(np.linspace(0, 300, 7))
    assert "forward whirl" in (tmp_path / "found.svg").read_text()


@pytest.mark.parametrize(
    "options, words",
    [
        (["--over", "spin=5"], "found one value, expected two or more"),
        (["--over", "spinn=0:5:3"], "did you mean 'spin'?"),
        (["--over", "spin=0:5 kg:3"], "expected"),
        (["--order", "2"], "found no --over"),
        (["--over", "spin=0:5:3", "--from", "found.npz"], "expected a state that follows from SCENE"),
        (["--over", "spin=0:5:3", "-o", "found.npz"], "found the ending '.npz'"),
    ],
)
def test_wrong_options_are_refused_in_a_sentence(rigid, options, words):
    refused = CliRunner().invoke(main, ["modes", str(rigid), *options])
    assert refused.exit_code == 2
    assert words in refused.output


ONE = """
name: One mass
gravity: [0, 0]
parameters: {k: 100 N/m, c: 0 N s/m}
bodies: {a: {mass: 1, inertia: 1}}
joints: {guide: {type: prismatic, i: a, j: ground}}
forces: {f: {type: spring_damper, i: a, j: {body: ground, point: [-1, 0]}, stiffness: k, free_length: 1 m, damping: c}}
"""


def test_a_mass_on_a_spring_is_unstable_below_no_stiffness_and_overdamped_above_a_limit(tmp_path):
    path = tmp_path / "one.yaml"
    path.write_text(ONE)
    by_stiffness = stiffmbs.campbell(path, "k", "-50:200 N/m:6")
    (limit,) = by_stiffness.limits()
    assert (limit.value, limit.growing) == (pytest.approx(0.0, abs=1e-3), False)
    assert "unstable" in by_stiffness.table()
    by_damping = stiffmbs.campbell(path, "c", "0:40:9")  # critical at 20 N s/m
    assert by_damping.limits() == ()
    expected = np.sqrt(np.maximum(100 - by_damping.values**2 / 4, 0.0)) / (2 * np.pi)
    (branch,) = by_damping.branches
    np.testing.assert_allclose(branch.frequencies, expected, atol=1e-9)
    np.testing.assert_allclose(branch.damping_ratios, by_damping.values / 20, atol=1e-9)


def test_a_note_on_a_state_is_made_once():
    """Values and positions differ from one value to the next."""
    scene = "examples/flexible/flexible_slider_crank.yaml"
    found = stiffmbs.campbell(scene, "bodies.crank.mass", [1.0, 1.5, 2.0])
    assert len([note for note in found.notes if "not an equilibrium" in note]) == 1


def test_a_single_value_is_refused(rigid):
    with pytest.raises(InputError, match="spin: found one value"):
        stiffmbs.campbell(rigid, "spin", [1.0])


def test_equal_values_count_once(tmp_path):
    path = tmp_path / "one.yaml"
    path.write_text(ONE)
    assert stiffmbs.campbell(path, "k", [100.0, 100.0, 200.0, 200.0]).values.tolist() == [100.0, 200.0]
    with pytest.raises(InputError, match="k: found one value"):
        stiffmbs.campbell(path, "k", [100.0, 100.0])


UNDAMPED = """
name: Two masses
gravity: [0, 0]
parameters: {k: 100 N/m}
bodies: {a: {mass: 1, inertia: 1}, b: {mass: 1, inertia: 1, position: [3, 0]}}
joints: {g: {type: prismatic, i: a, j: ground}, h: {type: prismatic, i: b, j: ground}}
forces:
  fa: {type: force, i: a, force: ["-k*a.x - (20 N/m)*(a.x - b.x + 3 m)", 0]}
  fb: {type: force, i: b, force: ["-(50 N/m)*(b.x - 3 m) + (20 N/m)*(a.x - b.x + 3 m)", 0]}
"""


@pytest.mark.parametrize("count", [5, 9, 17, 26])
def test_rounding_of_undamped_modes_is_no_limit_of_stability(tmp_path, count):
    """The stiffness matrix [[k + 20, -20], [-20, 70]] is singular at k = -100/7; real parts above are rounding of either sign."""
    path = tmp_path / "undamped.yaml"
    path.write_text(UNDAMPED)
    (limit,) = stiffmbs.campbell(path, "k", f"-200:200 N/m:{count}").limits()
    assert limit.value == pytest.approx(-100 / 7, abs=2e-4 * 400 / (count - 1))
    assert not limit.growing


COLUMN = """
name: Column under a follower force
gravity: [0, 0]
parameters: {P: 0 N, d: 0 N m s}
bodies:
  a: {mass: 2, inertia: 1e-9, position: [1, 0], markers: {s: {point: [-1, 0]}}}
  b: {mass: 1, inertia: 1e-9, position: [2, 0], markers: {s: {point: [-1, 0]}}}
joints: {p: {type: revolute, i: a.s, j: ground}, q: {type: revolute, i: b.s, j: a}}
forces:
  ta: {type: torque, i: a, torque: "(10 N m)*(b.angle - 2*a.angle) + d*(b.omega - 2*a.omega)"}
  tb: {type: torque, i: b, torque: "-(10 N m)*(b.angle - a.angle) - d*(b.omega - a.omega)"}
  P: {type: force, i: b, force: ["-P", 0], axes: body}
"""


@pytest.mark.parametrize("damping, expected", [("0", 10 * (3.5 - np.sqrt(2))), ("0.1", 10 * (41 / 28 + 0.5e-3))])
@pytest.mark.parametrize("count", [4, 7, 13, 61])
def test_flutter_of_a_column_is_found_for_any_number_of_values(tmp_path, damping, expected, count):
    """Two modes meet at 20.858 N; at 49.142 N their real eigenvalues form other pairs, which is no limit.

    H. Ziegler, Die Stabilitätskriterien der Elastomechanik, Ing.-Arch. 20 (1952) 49-56: (7/2 - sqrt 2) k/l without damping, and
    (41/28 + d^2/(2 k m l^2)) k/l with it.
    """
    path = tmp_path / "column.yaml"
    path.write_text(COLUMN)
    (limit,) = stiffmbs.campbell(path, "P", f"0:60 N:{count}", changes=[("d", damping)]).limits()
    assert limit.value == pytest.approx(expected, abs=1.5e-4 * 60 / (count - 1))
    assert limit.growing


def test_stiff_axial_modes_do_not_hide_slow_growth():
    """A material damping of 0.02 ms drives the forward whirl of a shaft whose axial modes have 170 000 rad/s."""
    changes = [("unbalance", "0"), ("c", "0.1 N s/m")]
    found = stiffmbs.campbell("examples/beams/rotor.yaml", "spin", "100:300 rad/s:3", changes=changes)
    (limit,) = found.limits()
    growths = [
        max(stiffmbs.campbell("examples/beams/rotor.yaml", "spin", [value, 600.0], changes=changes).branches[k].growth[0] for k in range(8))
        for value in (limit.value - 1.0, limit.value + 1.0)
    ]  # fmt: skip
    assert growths[0] < 1e-6 < 1e-3 < growths[1]


@pytest.mark.parametrize("values", ["0:28 rad/s:5", "-28:-3 rad/s:4", "0:28 rad/s:29"])
def test_a_mode_that_begins_to_oscillate_meets_its_order(tmp_path, values):
    """s^2 + 20 s + 2 w^2 = 0 oscillates above w = sqrt 50 rad/s, with w at 10 rad/s."""
    path = tmp_path / "driven.yaml"
    path.write_text("""
name: Stiffness by speed
gravity: [0, 0]
parameters: {w: 1 rad/s}
bodies: {a: {mass: 1, inertia: 1}}
joints: {guide: {type: prismatic, i: a, j: ground}}
forces: {f: {type: force, i: a, force: ["-(2 kg)*w^2*a.x - (20 N s/m)*a.vx", 0]}}
""")
    (critical,) = stiffmbs.campbell(path, "w", values).critical()
    assert abs(critical.value) == pytest.approx(10.0, rel=1e-3)
    assert critical.frequency == pytest.approx(10.0 / (2 * np.pi), rel=1e-3)


@pytest.mark.parametrize("values, ends", [("-300:-100 rad/s:5", [-300.0]), ("-300:200 rad/s:6", [-300.0, 200.0])])
def test_lines_of_orders_are_drawn_where_the_values_are(rigid, values, ends):
    above, _ = stiffmbs.campbell(rigid, "spin", values).plot().axes
    lines = [line.get_xdata() for line in above.lines if line.get_linestyle() == "--"]
    assert sorted(float(line[-1]) for line in lines) == pytest.approx(ends)
