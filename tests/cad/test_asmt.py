"""Assemblies of FreeCAD's solver: motions and forces against its own results, and messages."""

from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.cad.assembly import CadFault
from stiffmbs.cad.load import load_cad
from stiffmbs.cad.ondsel.series import stored_results
from stiffmbs.elements.spatial.orientation import matrix
from stiffmbs.errors import InputError
from stiffmbs.results.listings import differences

from .asmt_files import CRANK, MOTION

DATA = Path(__file__).parents[1] / "data" / "cad"
DISTANCES = ("gears", "links", "line", "table")
"""Mechanisms whose accelerations OndselSolver computes otherwise than as the rate of its velocities."""
ON_J = ("slot", "bearing")
"""Joints whose reaction the scene reports on the part of marker J: points on a line or plane of I."""

PIVOT = "\t\tRefPoint\n\t\t\tMarkers\n\t\t\t\tMarker\n\t\t\t\t\tName\n\t\t\t\t\t\tpivot\n"
"""A second marker of this name."""
WITHOUT_TORQUE = "joint"
"""Joint of constant velocity, of which OndselSolver reports no torque; those of its neighbours contain it."""


def _pose(run, body, centre, rows):
    """The origin of a part's frame and its angular velocity, in ground axes."""
    axes = [matrix([run[f"{body}.q{k}"][row] for k in range(4)]) for row in rows]
    of = lambda what: np.array([[run[f"{body}.{what}{axis}"][row] for axis in "xyz"] for row in rows])  # noqa: E731
    origin = of("") - np.array([turned @ centre for turned in axes])
    return origin, np.array([turned @ w for turned, w in zip(axes, of("w"), strict=True)])


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "name", ["shafts", pytest.param("rods", marks=pytest.mark.long), pytest.param("plates", marks=pytest.mark.long)]
)
def test_motion_and_forces_are_those_of_freecads_solver(name):
    """Positions and velocities of all parts, and the force and torque of each joint, at each output time."""
    path = DATA / f"{name}.asmt"
    stored, scene = stored_results(path.read_text()), load_cad(path)
    run = stiffmbs.run(scene, rtol=1e-9)
    rows = [int(np.argmin(np.abs(run.t - t))) for t in stored["time"]]
    np.testing.assert_allclose(run.t[rows], stored["time"], atol=1e-12)
    for body, described in scene.bodies.items():
        origin, omega = _pose(run, body, np.array(described.center_of_mass), rows)
        for found, expected in ((origin, ""), (omega, "Omega")):
            of_file = np.array([stored[f"{body}.{expected}{axis}"] for axis in "XYZ"]).T
            np.testing.assert_allclose(found[1:], of_file[1:], atol=1e-9)
    compared = 0
    for channel in (f"{joint}.{part}" for joint in scene.joints for part in ("fx", "fy", "fz", "tx", "ty", "tz")):
        mechanism, _, joint = channel.partition(".")[0].partition("_")
        if mechanism in DISTANCES or channel not in stored or (joint in (*ON_J, WITHOUT_TORQUE) and ".t" in channel):
            continue
        sign = -1 if joint in ON_J else 1
        if joint.endswith("motor") or joint == "jack":  # its torque is about another point
            continue
        np.testing.assert_allclose(
            sign * run[channel][rows][1:], stored[channel][1:], rtol=1e-8, atol=1e-8, err_msg=channel
        )
        compared += 1
    assert compared > 30


def _read(tmp_path, text):
    path = tmp_path / "rig.asmt"
    path.write_text(text)
    return load_cad(path)


def test_a_physical_pendulum_starts_with_its_angular_acceleration(tmp_path):
    """m g L/(J + m L^2) with the principal moments about the centre of mass, and the velocity of the centre L omega."""
    run = stiffmbs.run(_read(tmp_path, CRANK), duration=1e-6, points=2)
    assert run["arm.wdz"][0] == pytest.approx(-2 * 9.81 * 0.5 / (0.2 + 2 * 0.25), rel=1e-9)
    assert run["arm.vy"][0] == pytest.approx(1.0)
    assert run["arm.x"][0] == pytest.approx(0.6)


@pytest.mark.parametrize("step", [2, 3, 4])
def test_spaces_and_comments_are_read_as_tabs_are(tmp_path, step):
    """MotionSim, a workbench of FreeCAD, indents by four spaces, and has no first line."""
    spaced = "# a comment\n" + CRANK.replace("OndselSolver\n", "").replace("\t", step * " ")
    one, other = _read(tmp_path, CRANK), _read(tmp_path, spaced)
    assert one.bodies == other.bodies and one.joints == other.joints


def test_joints_named_by_a_build_of_gcc_are_known(tmp_path):
    assert _read(tmp_path, CRANK.replace("RevoluteJoint", "luteJointE")).joints["hinge"].kind == "revolute"


def test_a_motion_turns_j_relative_to_i(tmp_path):
    """The arm is I here, so that it turns against the motion."""
    run = stiffmbs.run(_read(tmp_path, CRANK.replace("\t\tMotions\n", MOTION)))
    np.testing.assert_allclose(run["arm.wz"], 2.0, rtol=1e-9)


@pytest.mark.long
def test_a_later_start_is_in_the_laws(tmp_path):
    text = CRANK.replace("\t\tMotions\n", MOTION.replace("-2.0d*time", "-time*time"))
    late = text.replace("\t\ttend\n\t\t\t0.5", "\t\ttstart\n\t\t\t1\n\t\ttend\n\t\t\t1.5")
    assert stiffmbs.run(_read(tmp_path, late))["arm.wz"][0] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("/Rig/arm/hub", "/Rig/arm/hob", "line 36, MarkerI: found /Rig/arm/hob, expected the path of a marker"),
        ("RevoluteJoint", "HingeJoint", "hinge: found HingeJoint, expected one of FixedJoint"),
        ("\t\t\t\t\t2\n", "\t\t\t\t\ttwo\n", "Mass: found 'two', expected a number"),
        ("\t\t\t\t\t2\n", "\t\t\t\t\t-2\n", "arm: found a mass of -2"),
        ("\t\t\t0.5\n", "\t\t\t-1\n", "found the times 0 to -1"),
        ("Assembly\n", "Asembly\n", "found 0 lines 'Assembly'"),
        ("0.01	0.2	0.2", "0.01	0.2", "MomentOfInertias: found .0.01 0.2., expected 3 numbers"),
        ("\t\tMotions\n", MOTION.replace("time", "theta"), "found theta in '-2.0d.theta', expected one of time"),
        ("\t\tMotions\n", MOTION.replace("RotationalMotion", "TranslationalMotion"), "motion of hinge, expected the name of a Trans"),
        ("\t\tMotions\n", MOTION.replace("RotationalMotion", "GeneralMotion"), "found GeneralMotion, expected one of Rot"),
        ("\t\tMotions\n", MOTION + MOTION.removeprefix("\t\tMotions\n"), "motor: found two motions motor, expected unique"),
        ("\tParts\n", "\tConstantGravity\n\t\t0 0 0\n\tParts\n", "found ConstantGravity twice in Assembly"),
        ("\tParts\n", PIVOT + "\tParts\n", "found two markers pivot, expected unique"),
        ("\tParts\n", "".join("\t" * k + "x\n" for k in range(1, 1500)) + "\tParts\n", "nested too deeply"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(tmp_path, old, new, message):
    assert old in CRANK
    with pytest.raises(InputError, match=message):
        _read(tmp_path, CRANK.replace(old, new, 1))


def test_a_motion_is_left_out_with_its_joint(tmp_path):
    scene = _read(tmp_path, CRANK.replace("\t\tMotions\n", MOTION).replace("/Rig/pivot", "/Rig/arm/hub"))
    assert not scene.joints
    assert "motions of joints that are left out are left out: motor" in scene.notes


def test_entries_without_effect_are_noted(tmp_path):
    """Limits change the motion of FreeCAD's solver; none is dropped without a word."""
    limited = CRANK.replace(
        "\tConstantGravity", "\t\tLimits\n\t\t\tRotationLimit\n\t\t\t\tName\n\t\t\t\t\tstop\n\tConstantGravity"
    )
    notes = " ".join(_read(tmp_path, limited.replace("\t\ttend", "\t\thmax\n\t\t\t1\n\t\ttend")).notes)
    assert "ConstraintSets Limits" in notes and "SimulationParameters hmax" in notes


def test_parts_without_mass_move_by_their_joints_alone(tmp_path):
    massless = (
        CRANK.replace("\t\tMotions\n", MOTION)
        .replace("\t\t\t\t\t2\n", "\t\t\t\t\t0\n")
        .replace("0.01	0.2	0.2", "0	0	0")
    )
    scene = _read(tmp_path, massless)
    assert any("1 kg is used for each" in note for note in scene.notes)
    np.testing.assert_allclose(stiffmbs.run(scene)["arm.wz"], 2.0, rtol=1e-9)


@pytest.mark.long
def test_results_of_a_file_are_a_listing():
    """`stiffmbs diff` compares the forces of joints with those in the file."""
    run = stiffmbs.run(load_cad(DATA / "shafts.asmt"), rtol=1e-9)
    found = {one.channel: one.relative for one in differences(run, DATA / "shafts.asmt", {})}
    assert found["rack_teeth.fx"] < 1e-9 and found["screw_sleeve.fx"] < 1e-9


def test_results_with_the_line_ends_of_windows_are_the_same():
    text = (DATA / "shafts.asmt").read_text()
    one, other = stored_results(text), stored_results(text.replace("\n", "\r\n"))
    assert one.keys() == other.keys() and all(np.array_equal(one[name], other[name]) for name in one)


@pytest.mark.parametrize(
    ("change", "message"),
    [("\t0\t", "found 8 numbers, expected 7, as there are 6 times"), ("\tx", "found '.* x', expected numbers")],
)
def test_a_damaged_row_of_results_is_refused(change, message):
    """It was shifted, or left out."""
    head, label, row = (DATA / "shafts.asmt").read_text().rpartition("\nFXonI")
    values, end, rest = row.partition("\t\n")
    with pytest.raises(CadFault, match=message):
        stored_results(f"{head}{label}{values}{change}{end}{rest}")


@pytest.mark.long
def test_the_force_between_teeth_acts_at_the_pitch_radius():
    """The torque of the mesh on wheel I is the force times its radius of 0.2 m, and the axles carry the force."""
    run = stiffmbs.run(load_cad(DATA / "shafts.asmt"), rtol=1e-9)
    force = np.hypot(run["gears_mesh.fx"], run["gears_mesh.fy"])
    assert np.max(force) > 1
    np.testing.assert_allclose(0.2 * force, np.abs(run["gears_mesh.tz"]), rtol=1e-4)
