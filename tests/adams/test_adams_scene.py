"""Adams datasets as scenes: what becomes of every statement."""

import ast
import math

import numpy as np
import pytest

from stiffmbs.errors import InputError
from stiffmbs.reading.formula.text import evaluate

from .adams_parts import made


def joint(text, **kwargs):
    found = made(text, **kwargs)["joints"]
    return found[next(reversed(found))]


def test_a_title_names_the_scene():
    found = made("")
    assert found["name"] == "thing" and found["dimensions"] == 3 and list(found["bodies"]) == ["PART_2", "PART_3"]


def test_a_body_has_the_axes_of_its_center_of_mass_marker():
    found = made("""PART/4, MASS=2, CM=41, IP=3,4,5, QG=1,2,3, REULER=90D,0,0, VX=1, VZ=2, WX=7
MARKER/41, PART=4, QP=1,0,0, REULER=0,90D,0
MARKER/42, PART=4, QP=1,1,0
""")["bodies"]["PART_4"]
    assert found["mass"] == 2 and found["inertia"] == [3, 4, 5] and found["position"] == [1, 3, 3]
    c = math.sqrt(0.5)
    # about z by 90 degrees, then about the new x by 90 degrees
    np.testing.assert_allclose(found["orientation"], np.array([0.5, 0.5, 0.5, 0.5]), atol=1e-15)
    assert found["velocity"] == [1, 0, 2] and found["omega"] == [7, 0, 0]
    assert found["markers"]["MARKER_41"] == {"point": [0, 0, 0]}
    np.testing.assert_allclose(found["markers"]["MARKER_42"]["point"], [0, 0, -1], atol=1e-15)
    np.testing.assert_allclose(found["markers"]["MARKER_42"]["orientation"], [c, -c, 0, 0], atol=1e-15)


def test_velocities_may_be_given_in_the_axes_of_markers():
    found = made("""PART/4, MASS=2, CM=41, IP=3,4,5, VX=1, VM=42, WY=3, WM=42
MARKER/41, PART=4
MARKER/42, PART=4, REULER=90D,0,0
""")["bodies"]["PART_4"]
    assert found["velocity"] == [0, 1, 0] and found["omega"] == [-3, 0, 0]


def test_products_of_inertia_are_positive_integrals():
    """Two masses of 1 at (1, 1, 0) and (-1, -1, 0): Ixx = Iyy = 2, Izz = 4, and the integral of xy is 2."""
    found = made("PART/4, MASS=2, CM=41, IP=2.5,2.5,4.5, 2,0,0\nMARKER/41, PART=4")["bodies"]["PART_4"]
    assert found["inertia"] == [[2.5, -2, 0], [-2, 2.5, 0], [0, 0, 4.5]]


def test_moments_may_be_about_another_marker():
    """A ball with 0.4 about its centre, given about a turned marker at a distance of 2."""
    text = """PART/4, MASS=1, CM=41, IM=42, IP={}
MARKER/41, PART=4, QP=0,0,1
MARKER/42, PART=4, QP=0,0,3, REULER=30D,40D,0
"""
    axis = np.array([0, 0, 1.0])  # of the part, along which the marker is away
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    C, S = math.cos(math.radians(40)), math.sin(math.radians(40))
    axes = np.array([[c, -s * C, s * S], [s, c * C, -c * S], [0, S, C]])
    along = axes.T @ axis
    tensor = 0.4 * np.eye(3) + 4 * (np.eye(3) - np.outer(along, along))
    moments = [*np.diag(tensor), -tensor[0, 1], -tensor[0, 2], -tensor[1, 2]]
    found = made(text.format(", ".join(repr(float(m)) for m in moments)))["bodies"]["PART_4"]["inertia"]
    np.testing.assert_allclose(np.diag(found) if np.ndim(found) == 1 else found, 0.4 * np.eye(3), atol=1e-14)


def test_a_point_mass_keeps_its_orientation():
    found = made("POINT_MASS/4, MASS=2, CM=41, QG=1,0,0\nMARKER/41, POINT_MASS=4, QP=0,0,1")
    assert found["bodies"]["POINT_MASS_4"]["position"] == [1, 0, 1]
    assert found["joints"]["POINT_MASS_4_axes"] == {"type": "orientation", "i": "POINT_MASS_4", "j": "ground"}


@pytest.mark.parametrize(
    "text, words",
    [
        ("PART/4, MASS=-1, CM=41, IP=1,1,1\nMARKER/41, PART=4", "PART/4: found MASS = -1"),
        ("PART/4, MASS=1, IP=1,1,1", "PART/4: found no CM"),
        ("PART/4, MASS=1, CM=21, IP=1,1,1", "PART/4: found CM = 21, expected a marker of this part"),
        (
            "PART/4, MASS=1, CM=41, IP=-1,1,1\nMARKER/41, PART=4",
            "PART/4: found principal moments of inertia -1, 1 and 1",
        ),
        (
            "PART/4, MASS=1, CM=41, IP=1,1,-3\nMARKER/41, PART=4",
            "PART/4: found principal moments of inertia -3, 1 and 1",
        ),
        ("PART/4, GROUND", "PART/4: found a second GROUND, expected one \\(PART/1\\)"),
        ("MARKER/41, PART=4", "MARKER/41: found PART = 4, expected the number of a PART of the dataset"),
        ("JOINT/1, FIXED, I=1, J=99", "JOINT/1: found J = 99, expected the number of a marker"),
    ],
)
def test_parts_that_cannot_be_are_told(text, words):
    with pytest.raises(InputError, match=words):
        made(text)


@pytest.mark.parametrize(
    "kind, expected",
    [
        ("REVOLUTE", "revolute"),
        ("TRANSLATIONAL", "prismatic"),
        ("CYLINDRICAL", "cylindrical"),
        ("SPHERICAL", "spherical"),
        ("UNIVERSAL", "universal"),
        ("PLANAR", "planar"),
        ("CONVEL", "constant_velocity"),
        ("FIXED", "fixed"),
    ],
)
def test_joints_take_their_markers_as_they_are(kind, expected):
    found = made(f"JOINT/7, {kind}, I=1, J=22")["joints"]
    assert found == {"JOINT_7": {"type": expected, "i": "ground.MARKER_1", "j": "PART_2.MARKER_22"}}


@pytest.mark.parametrize(
    "kind, expected",
    [
        ("ATPOINT", "spherical"),
        ("INLINE", "point_on_line"),
        ("INPLANE", "point_on_plane"),
        ("ORIENTATION", "orientation"),
        ("PARALLEL_AXES", "parallel"),
        ("PERP", "perpendicular"),
    ],
)
def test_primitives_are_joints(kind, expected):
    assert made(f"JPRIM/7, {kind}, I=22, J=1")["joints"]["JPRIM_7"]["type"] == expected


def test_the_arms_of_a_hooke_joint_are_x_of_i_and_y_of_j():
    found = joint("JOINT/1, HOOKE, I=2, J=22")
    from stiffmbs.elements.spatial.orientation import matrix

    assert found["type"] == "universal" and found["i"]["point"] == [0, 0, 1] and found["j"]["point"] == [-1, 0, 0]
    np.testing.assert_allclose(matrix(found["i"]["orientation"])[:, 2], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(matrix(found["j"]["orientation"])[:, 2], [0, 1, 0], atol=1e-15)


def test_screws_are_threads_and_racks_are_equations_of_rates():
    screw = joint("JOINT/1, SCREW, I=22, J=1, PITCH=500", length="MILLIMETER")
    assert screw == {"type": "thread", "i": "PART_2.MARKER_22", "j": "ground.MARKER_1", "pitch": 0.5}
    rack = joint("MARKER/24, PART=3, QP=0,-0.5,0, REULER=90D,90D,0\nJOINT/1, RACKPIN, I=22, J=24, PD=1")
    assert rack["zero"].startswith("vz(PART_3.MARKER_24, PART_2.MARKER_22, PART_3.MARKER_24) - (wx(")
    with pytest.raises(InputError, match="JOINT/1: found the rack's line"):
        made("JOINT/1, RACKPIN, I=22, J=33, PD=1")


def test_a_constant_distance_is_a_rod_and_other_constraints_are_equations():
    text = "GCON/1, I=1, FUNCTION=DM(22, 1) - 2000\nGCON/2, FUNC = DX(22,1)+TIME\nGCON/3, FUNC=VX(22)-WZ(22)*DY(22)"
    found = made(text, length="MILLIMETER")["joints"]
    assert found["GCON_1"] == {"type": "distance", "i": "ground.MARKER_1", "j": "PART_2.MARKER_22", "length": 2}
    assert found["GCON_2"] == {"type": "equation", "zero": "dx(PART_2.MARKER_22, ground.MARKER_1) / 0.001 + t"}
    assert joint("GCON/4, I=1, FUNC=DX(22,1)")["i"] == "ground.MARKER_1"
    assert found["GCON_3"]["type"] == "velocity_equation"


JOINTS = """JOINT/1, REVOLUTE, I=22, J=1
JOINT/2, TRANSLATIONAL, I=33, J=1
JOINT/3, CYLINDRICAL, I=21, J=1
"""


def test_motions_drive_joints():
    found = made(
        JOINTS + "MOTION/1, JOINT=1, FUNCTION=360D*TIME\nMOTION/2, JOINT=2, VELOCITY, FUNC=30*SIN(TIME)", "MILLIMETER"
    )
    assert found["joints"]["MOTION_1"] == {"type": "drive", "joint": "JOINT_1", "position": "6.283185307179586 * t"}
    assert found["joints"]["MOTION_2"] == {"type": "drive", "joint": "JOINT_2", "velocity": "0.001 * (30 * sin(t))"}


def test_a_cylindrical_joint_is_driven_along_or_about_its_axis():
    slide = joint(JOINTS + "MOTION/1, JOINT=3, TRANS, FUNC=TIME")
    assert slide == {"type": "drive", "joint": "JOINT_3.displacement", "position": "t"}
    turn = joint(JOINTS + "MOTION/1, JOINT=3, ROT, FUNC=TIME")
    assert turn == {"type": "drive", "joint": "JOINT_3.angle", "position": "t"}
    with pytest.raises(InputError, match="MOTION/1: found neither ROTATIONAL nor TRANSLATIONAL of JOINT/3"):
        made(JOINTS + "MOTION/1, JOINT=3, FUNC=TIME")


@pytest.mark.parametrize(
    "text, expected",
    [
        ("ACCELERATION, FUNC=2", lambda t: t * t),
        ("ACCELERATION, FUNC=6*TIME, ICVEL=0.5", None),
        ("ACCELERATION, ICVEL=0.5, ICDISP=0.25, FUNC=6*TIME", lambda t: 0.25 + 0.5 * t + t**3),
        ("ACCEL, FUNC=-SIN(2*TIME)*4", lambda t: np.sin(2 * t) - 2 * t),
        ("VELOCITY, ICDISP=1, FUNC=COS(TIME)", lambda t: 1 + np.sin(t)),
    ],
)
def test_accelerations_are_integrated(text, expected):
    if expected is None:  # FUNCTION has to be the last argument
        with pytest.raises(InputError, match="ICVEL"):
            joint(JOINTS + f"MOTION/1, JOINT=2, {text}\\\n, NOTHING")
        return
    tree = ast.parse(joint(JOINTS + f"MOTION/1, JOINT=2, {text}")["position"], mode="eval").body
    for t in (0.0, 0.7):
        value = evaluate(tree, {"t": t}.__getitem__, {"sin": math.sin, "cos": math.cos})
        assert value == pytest.approx(expected(t), abs=1e-12)


def test_integrals_that_are_no_formula_are_states():
    found = made(JOINTS + "MOTION/1, JOINT=2, ACCELERATION, ICVEL=0.5, FUNC=STEP(TIME,0,0,1,1)")
    assert found["joints"]["MOTION_1"]["position"] == "MOTION_1_displacement"
    assert found["states"] == {
        "MOTION_1_displacement": {"rate": "MOTION_1_velocity", "start": 0},
        "MOTION_1_velocity": {"rate": "step(t, 0, 0, 1, 1)", "start": 0.5},
    }


@pytest.mark.parametrize("function", ["DX(22,1)", "JOINT(1,0,2,0)*STEP(TIME,0,0,1,1)"])
def test_integrals_of_what_moves_are_refused(function):
    with pytest.raises(InputError, match=r"MOTION/1: found '.*' measured in '.*', expected a function of time"):
        made(JOINTS + f"MOTION/1, JOINT=2, ACCELERATION, FUNC={function}")


def test_components_between_markers_are_driven():
    found = made(
        "MOTION/1, I=22, J=2, Y, FUNC=TIME\nMOTION/2, I=22, J=2, B1, FUNC=TIME\nMOTION/3, I=22, J=2, B3, FUNC=0"
    )["joints"]
    assert found["MOTION_1"]["coordinate"] == "dy(PART_2.MARKER_22, ground.MARKER_2, ground.MARKER_2)"
    assert found["MOTION_2"]["coordinate"] == "ax(PART_2.MARKER_22, ground.MARKER_2)"
    assert found["MOTION_3"]["coordinate"] == "-az(ground.MARKER_2, PART_2.MARKER_22)"


def test_couplers_tie_joints():
    found = made(JOINTS + "COUPLER/1, JOINTS=1,2, TYPE=R:T, SCALES=1,-0.5", "MILLIMETER")["joints"]["COUPLER_1"]
    assert found == {"type": "coupler", "joint_1": "JOINT_1", "joint_2": "JOINT_2", "scale": 500}
    three = joint(JOINTS + "COUPLER/1, JOINTS=1,2,3, TYPE=R:T:T, SCALES=2,-1,4")
    assert three["type"] == "equation"
    assert three["zero"] == (
        "1 * az(PART_2.MARKER_22, ground.MARKER_1) + -0.5 * dz(PART_3.MARKER_33, ground.MARKER_1, ground.MARKER_1) + "
        "2 * dz(PART_2.MARKER_21, ground.MARKER_1, ground.MARKER_1)"
    )


GEARS = """JOINT/1, REVOLUTE, I=22, J=1
MARKER/11, PART=1, QP=3,0,0
MARKER/34, PART=3, QP=3,0,0
JOINT/2, REVOLUTE, {}
MARKER/12, PART=1, QP=1,0,0, REULER=0,90D,0
GEAR/1, JOINTS=1,2, CV=12
"""


def test_gears_turn_by_the_distances_of_their_contact():
    """Wheels of radius 1 and 2 side by side, whichever marker of a joint is on the wheel; force and torque of the teeth."""
    for pair in ("I=34, J=11", "I=11, J=34"):
        meshed = joint(GEARS.format(pair))
        assert meshed["type"] == "equation" and meshed["i"] == "PART_2.MARKER_22" and meshed["j"] == "PART_3.MARKER_34"
        assert meshed["zero"] == (
            "dz(PART_2.MARKER_22, ground.MARKER_1, ground.MARKER_12) + -1.0 * az(PART_2.MARKER_22, ground.MARKER_1) + -1.0 * "
            "(dz(PART_3.MARKER_34, ground.MARKER_11, ground.MARKER_12) + 2.0 * az(PART_3.MARKER_34, ground.MARKER_11))"
        )
    with pytest.raises(InputError, match="GEAR/1: found the z axis of the marker CV normal to the motion"):
        made(GEARS.format("I=34, J=11").replace("QP=1,0,0, REULER=0,90D,0", "QP=1,0,0"))
    with pytest.raises(InputError, match="GEAR/1: found the marker CV on PART_3"):
        made(GEARS.format("I=34, J=11").replace("MARKER/12, PART=1", "MARKER/12, PART=3"))


def test_single_forces():
    found = made(
        "SFORCE/1, TRANS, I=22, J=1, FUNC=-3*DM(22,1)\nSFORCE/2, ROT, I=22, J=1, FUNC=2000\nSFORCE/3, TRANS, ACTION, I=22, J=23, FUNC=1",
        "MILLIMETER",
    )["forces"]
    assert found["SFORCE_1"] == {
        "type": "line_force", "i": "PART_2.MARKER_22", "j": "ground.MARKER_1",
        "force": "-3 * (dm(PART_2.MARKER_22, ground.MARKER_1) / 0.001)",
    }  # fmt: skip
    assert found["SFORCE_2"] == {
        "type": "torque", "i": "PART_2.MARKER_22", "j": "ground.MARKER_1", "torque": [0, 0, "0.001 * 2000"],
        "frame": "ground.MARKER_1",
    }  # fmt: skip
    assert found["SFORCE_3"] == {
        "type": "force", "i": "PART_2.MARKER_22", "force": [0, 0, "1"], "frame": "PART_2.MARKER_23",
    }  # fmt: skip


def test_vector_forces():
    text = r"""GFORCE/1, I=22, JFLOAT=32, RM=2, FX=1\ FY=2\ TZ=TIME\
VTORQUE/2, I=22, JFLOAT=32, TX=0\TY=1\TZ=2"""
    found = made(text)["forces"]
    assert found["GFORCE_1"] == {
        "type": "force", "i": "PART_2.MARKER_22", "j": "PART_3", "force": ["1", "2", 0], "frame": "ground.MARKER_2",
    }  # fmt: skip
    assert found["GFORCE_1_torque"]["torque"] == [0, 0, "t"] and found["VTORQUE_2"]["type"] == "torque"


def test_springs_count_tension():
    found = made(
        "SPRING/1, TRANS, I=22, J=1, K=2, C=3, LENGTH=100, FORCE=5\nSPRING/2, ROT, I=22, J=1, KT=1000, ANGLE=90D, TORQUE=2",
        "MILLIMETER",
    )["forces"]
    assert found["SPRINGDAMPER_1"] == {
        "type": "spring_damper", "i": "PART_2.MARKER_22", "j": "ground.MARKER_1", "stiffness": 2000, "damping": 3000,
        "free_length": 0.1, "preload": -5,
    }  # fmt: skip
    assert found["SPRINGDAMPER_2"] == {
        "type": "torsion_spring", "i": "PART_2.MARKER_22", "j": "ground.MARKER_1", "stiffness": 1,
        "free_angle": math.pi / 2, "preload": -0.002,
    }  # fmt: skip


def test_bushings_and_fields_in_si():
    k = [[100 * (6 * min(row, column) + max(row, column)) for column in range(6)] for row in range(6)]
    columns = ", ".join(str(k[row][column]) for column in range(6) for row in range(6))
    text = f"BUSHING/1, I=22, J=1, K=1,2,3, KT=4,5,6, C=7,8,9, FORCE=1,0,0, TORQUE=0,0,1\nFIELD/2, I=22, J=1, KMATRIX={columns}, CRATIO=0.5, LENGTH=1,2,3,0,0,0.5"
    found = made(text, "MILLIMETER")["forces"]
    bushing, field = found["BUSHING_1"], found["FIELD_2"]
    np.testing.assert_allclose(bushing["stiffness"], [1000, 2000, 3000, 4e-3, 5e-3, 6e-3])
    np.testing.assert_allclose(bushing["damping"], [7000, 8000, 9000, 0, 0, 0])
    np.testing.assert_allclose(bushing["preload"], [1, 0, 0, 0, 0, 1e-3])
    K = np.array(field["stiffness"])
    np.testing.assert_allclose([K[0, 0], K[1, 2], K[1, 5], K[5, 1], K[3, 4]], [0, 8e5, 1100, 1100, 2.2])
    np.testing.assert_allclose(field["damping"], 0.5 * K)
    np.testing.assert_allclose(field["free"], [1e-3, 2e-3, 3e-3, 0, 0, 0.5])


def test_beams_in_si():
    section = "LENGTH=1000, AREA=100, IXX=2, IYY=3, IZZ=4, EMODULUS=2E5, GMODULUS=8E4, ASY=1.2, CRATIO=0.01"
    found = made(f"BEAM/1, I=22, J=1, {section}", "MILLIMETER")["forces"]["BEAM_1"]
    assert {key: pytest.approx(value) for key, value in found.items() if key not in ("type", "i", "j")} == {
        "length": 1, "area": 1e-4, "torsion": 2e-12, "iyy": 3e-12, "izz": 4e-12, "young": 2e11, "shear_modulus": 8e10,
        "asy": 1.2, "damping_ratio": 0.01,
    }  # fmt: skip
    half = ", ".join(str(k) for k in range(1, 22))
    rows = made(f"BEAM/1, I=22, J=1, {section.replace(', CRATIO=0.01', '')}, CMATRIX={half}")["forces"]["BEAM_1"][
        "damping"
    ]
    assert rows[0] == [1, 2, 3, 4, 5, 6] and rows[1][1:] == [7, 8, 9, 10, 11] and rows[5] == [6, 11, 15, 18, 20, 21]


def test_requests_between_markers():
    found = made("REQUEST/1, D, I=22, J=1\nREQUEST/2, V, I=22\nREQUEST/3, ACC, I=22, J=1, RM=2", "MILLIMETER")[
        "requests"
    ]
    assert list(found["REQUEST_1"]) == ["x", "y", "z", "psi", "theta", "phi"]
    assert found["REQUEST_1"]["y"] == "dy(PART_2.MARKER_22, ground.MARKER_1)"
    assert found["REQUEST_2"]["wx"] == "wx(PART_2.MARKER_22)"
    assert found["REQUEST_3"]["accz"] == "accz(PART_2.MARKER_22, ground.MARKER_1, ground.MARKER_2)"


def test_requests_of_forces():
    text = (
        JOINTS
        + r"""GFORCE/1, I=22, JFLOAT=32, FX=1\ TZ=2\
GCON/1, I=21, FUNCTION=DM(21,33)-2
REQUEST/1, F, I=22, J=1
REQUEST/2, F2=JOINT(1,0,2,0)\F3=JOINT(1,1,3,2)\F4=JOINT(2,0,1,0)\F6=MOTION(9,0,6,0)
REQUEST/3, F2=FX(1,22)\F3=TZ(22,32)\F4=GCON(1,0,2,0), CNAMES="a","b c"
REQUEST/4, F, I=1, J=33
REQUEST/5, F, I=2, J=21
"""
    )
    found = made(text, "MILLIMETER")
    requests = found["requests"]
    assert requests["REQUEST_1"]["fx"] == "fx(JOINT_1)" and requests["REQUEST_1"]["tz"] == "tz(JOINT_1)"
    assert requests["REQUEST_2"] == {
        "f2": "fx(JOINT_1)", "f3": "fy(JOINT_1.j, ground.MARKER_2)", "f4": "fm(JOINT_2)",
    }  # fmt: skip
    assert requests["REQUEST_3"] == {
        "a": "fx(JOINT_1.j)", "f3": "(tz(GFORCE_1) + tz(GFORCE_1_torque)) / 0.001", "f4": "fx(GCON_1)",
    }  # fmt: skip
    assert requests["REQUEST_4"]["fy"] == "fy(JOINT_2.j)"
    assert "REQUEST_5" not in requests
    told = "\n".join(found["notes"])
    assert "line 20, REQUEST/2: found MOTION(9, ...), expected the number of a MOTION" in told
    assert "line 23, REQUEST/5: found no joint and no force between the markers 2 and 21" in told


def test_notes_tell_what_is_left_out():
    found = made("PART/4, MASS=1, CM=41, IP=1,1,1, EXACT=X:Y\nMARKER/41, PART=4\nINTEGRATOR/GSTIFF, ERROR=1E-4")
    assert found["notes"] == [
        "INTEGRATOR (line 16) is left out: analysis settings",
        "EXACT of PART/4 is left out: assembly may move any part",
    ]


@pytest.mark.parametrize(
    "conditions, held",
    [
        ("ICROT=90D,3", {}),
        ("ICTRAN=0.25,2", {}),
        ("ICTRAN=,2", {}),
        ("ICROT=0,3", {"turn_position": 0, "turn_velocity": 3}),
        ("ICROT=0.5", {"turn_position": 0.5}),
        ("ICROT=,0", {"turn_velocity": 0}),
        ("ICTRAN=0.25,1, ICROT=90D", {"slide_position": 0.25, "slide_velocity": 1, "turn_position": np.pi / 2}),
    ],
)
def test_initial_conditions_of_joints_that_are_not_those_of_the_parts_hold_at_the_start(conditions, held):
    text = f"""PART/4, MASS=1, CM=41, IP=1,1,1, QG=0,0,0.25, REULER=90D,0,0, VZ=2, WZ=3
MARKER/41, PART=4
JOINT/1, CYLINDRICAL, I=41, J=1, {conditions}"""
    drives = made(text).get("at_start", {})
    assert {
        name: next(x for key, x in drive.items() if key in ("position", "velocity")) for name, drive in drives.items()
    } == {f"JOINT_1_{name}": value for name, value in held.items()}


def test_initial_conditions_that_a_joint_does_not_have_are_refused():
    with pytest.raises(InputError, match="JOINT/1: found IC of a CYLINDRICAL joint, expected ICROT or ICTRAN"):
        made("JOINT/1, CYLINDRICAL, I=21, J=1, IC=1")
    with pytest.raises(InputError, match="JOINT/1: found ICTRAN of a REVOLUTE joint, expected IC or ICROT"):
        made("JOINT/1, REVOLUTE, I=21, J=1, ICTRAN=1")
