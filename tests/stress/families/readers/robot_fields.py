"""Fields of URDF and MJCF files: followed, or noted where they are not used."""

from __future__ import annotations

from functools import partial
from importlib.util import find_spec
from pathlib import Path

from stiffmbs.analyses.run import run
from stiffmbs.robots.load import load_robot

from ...case import Case, Verdict, measured
from ...variants.answers import compared, refused, said, with_files

ALLOWED = 1e-6
URDF = """<robot name="r">
  <link name="base"/>
  <link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <link name="hand">HAND</link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5"/></joint>
  <joint name="wrist" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0.4 0 0"/>WRIST</joint>
</robot>"""
"""An arm whose hinge is at the base's origin, with a hand fixed to it."""


def hand(moment: str, mass: str = "") -> str:
    """Return the inertial data of the hand."""
    return f'<inertial>{mass}<inertia ixx="{moment}" ixy="0" ixz="0" iyy="{moment}" iyz="0" izz="{moment}"/></inertial>'


HANDS = {
    "no mass, 0.3 kg m^2": (hand("0.3"), 0.3, 0.0), "a mass of zero, 0.3 kg m^2": (hand("0.3", '<mass value="0"/>'), 0.3, 0.0),
    "moments of -2e-35": (hand("-2e-35", '<mass value="1"/>'), 0.0, 1.0), "moments of 1e-40 and no mass": (hand("1e-40"), 0.0, 0.0),
    "a point mass": (hand("0", '<mass value="0.5"/>'), 0.0, 0.5), "nothing": ("", 0.0, 0.0),
}  # fmt: skip
"""Inertial data, the moment and the mass that they add."""
PREFIXED = (
    ("</robot>", "<drake:x/></robot>", "<drake:x>"), ('<link name="base"/>', '<link name="base"><my:x/></link>', "<my:x>"),
    ('<robot name="r">', '<robot name="r" sensor:version="2">', "sensor:version"), ("</robot>", "<gazebo><mu1>3</mu1></gazebo></robot>", "robot <gazebo>"),
    ("WRIST", '<mimic joint="hinge" multiplier="2"/>', ""), ("</robot>", '<transmission name="t"><type>x</type></transmission></robot>', "transmission <type> of t"),
    ('effort="5"', 'velocity="2" effort="5"', "hinge -1 .. 1 rad and 2 rad/s"), ("HAND", "<visual><geometry/></visual>", "link <visual> of hand"),
)  # fmt: skip
"""A change, and what the notes name."""
MJCF = """<mujoco><option gravity="0 0 0" OPTION><flag contact="disable" FLAG/></option>
  <worldbody><body name="b"><inertial pos="0 0 0" mass="2" diaginertia="0.3 0.3 0.5"/>
    <joint name="h" axis="0 0 1" damping="0.7" stiffness="3" springref="20" JOINT/></body></worldbody>
  <tendon><fixed name="belt" TENDON><joint joint="h" coef="0.5"/></fixed></tendon>
  <actuator><motor name="m" joint="h" gear="4" group="1" ctrllimited="true" ctrlrange="-1 1"/><motor name="n" tendon="belt" gear="2" group="2"/></actuator>
</mujoco>"""
OMEGA, PULLS, SPRING = 2.0, (1.5, 3.0), 3 * 20 * 3.141592653589793 / 180
"""Speed, rad/s, inputs of both motors, and the spring's torque, N m."""
MOTIONS = {
    "plain": ({}, 4 + 3 + SPRING - 1.4), "a range of the joint": ({"JOINT": 'actuatorfrcrange="-1 5"'}, 5 + SPRING - 1.4),
    "a range that is not limited": ({"JOINT": 'actuatorfrclimited="false" actuatorfrcrange="-1 5"'}, 7 + SPRING - 1.4),
    "a range of the tendon": ({"TENDON": 'actuatorfrcrange="-1 2"'}, 4 + 2 + SPRING - 1.4),
    "both ranges": ({"TENDON": 'actuatorfrcrange="-1 2"', "JOINT": 'actuatorfrcrange="-1 5.5"'}, 5.5 + SPRING - 1.4),
    "group 1 disabled": ({"OPTION": 'actuatorgroupdisable="1"'}, 3 + SPRING - 1.4), "groups 1 and 2 disabled": ({"OPTION": 'actuatorgroupdisable="1 2"'}, SPRING - 1.4),
    "springs disabled": ({"FLAG": 'spring="disable"'}, 7 - 1.4), "dampers disabled": ({"FLAG": 'damper="disable"'}, 7 + SPRING),
    "actuation disabled": ({"FLAG": 'actuation="disable"'}, SPRING - 1.4), "inputs not clamped": ({"FLAG": 'clampctrl="disable"'}, 6 + 3 + SPRING - 1.4),
}  # fmt: skip
"""Changes, and the torque on 0.5 kg m^2."""
MJCF_NOTES = {
    'margin="0.2"': "joint margin of h", 'solreflimit="0.1 1"': "joint solref_limit of h", 'user="3"': "", 'actuatorgravcomp="true"': "joint actgravcomp of h",
}  # fmt: skip


def _swings(given: str, folder: Path) -> float:
    """Return the error of the angular acceleration that weight gives the arm and its hand."""
    inertial, moment, mass = HANDS[given]
    (folder / "r.urdf").write_text(URDF.replace("HAND", inertial).replace("WRIST", ""), encoding="utf-8")
    found = run(load_robot(folder / "r.urdf"), duration=1e-6, points=2)["arm.wdy"][0]
    expected = 9.81 * (2 * 0.2 + mass * 0.4) / (0.02 + 2 * 0.2**2 + moment + mass * 0.4**2)
    return abs(float(found) / expected - 1)


def _notes(text: str, change: tuple[str, str], folder: Path) -> str:
    name = "r.urdf" if text == URDF else "r.xml"
    text = text.replace(*change)
    for word in ("HAND", "WRIST", "OPTION", "FLAG", "JOINT", "TENDON"):
        text = text.replace(word, "")
    (folder / name).write_text(text, encoding="utf-8")
    scene = load_robot(folder / name)
    assert run(scene, duration=1e-6, points=2).t[-1] > 0
    return "; ".join(scene.notes)


def _turns(given: str, folder: Path) -> Verdict:
    """Judge the angular acceleration of a body on a hinge, 0.5 kg m^2."""
    changes, torque = MOTIONS[given]
    text = MJCF
    for word in ("OPTION", "FLAG", "JOINT", "TENDON"):
        text = text.replace(word, changes.get(word, ""))
    (folder / "r.xml").write_text(text, encoding="utf-8")
    known = load_robot(folder / "r.xml").inputs
    inputs = [
        (f"inputs.{name}_input", str(pull)) for name, pull in zip("mn", PULLS, strict=True) if f"{name}_input" in known
    ]
    scene = load_robot(folder / "r.xml", inputs, rates={"h": OMEGA})
    found = float(run(scene, duration=1e-6, points=2)["b.wdz"][0])
    return measured(abs(found - torque / 0.5), ALLOWED * 10, "; ".join(scene.notes))


URDFS = (
    *(compared(f"URDF: a hand with {given}", "the acceleration by hand", partial(with_files, {}, partial(_swings, given)), ALLOWED) for given in HANDS),
    *(said(f"URDF: {new[:40]}", "it is read, with a note", partial(with_files, {}, partial(_notes, URDF, (old, new))), *filter(None, (word,))) for old, new, word in PREFIXED),
    refused("URDF: moments of -1e-9", "no body has them", partial(with_files, {"r.urdf": URDF.replace("HAND", hand("-1e-9", '<mass value="1"/>')).replace("WRIST", "")}, lambda folder: load_robot(folder / "r.urdf")), "link hand: found the principal moments of inertia -"),
)  # fmt: skip
MJCFS = (
    *(Case(f"MJCF: {given}", "the acceleration by hand", partial(with_files, {}, partial(_turns, given))) for given in MOTIONS),
    *(said(f"MJCF: {field}", "a note where it has an effect", partial(with_files, {}, partial(_notes, MJCF, ("JOINT", field))), *filter(None, (word,))) for field, word in MJCF_NOTES.items()),
)  # fmt: skip
CASES = (*URDFS, *(MJCFS if find_spec("mujoco") else ()))
"""Those of MJCF where MuJoCo, which reads it, is installed."""
