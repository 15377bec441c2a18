"""Statements and commands of datasets in use: followed, or left out with a note; datasets that are written have their slashes."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from typing import cast

from stiffmbs.adams.export.dataset_text import dataset_text
from stiffmbs.adams.load import read_adams
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.spatial_model import SpatialData

from ...case import Case, Outcome, Verdict, measured, told
from ...variants.answers import compared, refused, with_files

G, ALLOWED = 9.80665, 1e-6
HEAD = """a model
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=MILLIMETER, TIME=SECOND
PART/1, GROUND
MARKER/10, PART=1
PART/2, MASS=2, CM=21, IP=2E4,2E4,2E4
MARKER/21, PART=2
ACCGRAV/KGRAV=-9806.65
"""
HELD = "JOINT/1, FIXED, I=21, J=10\n"
GSE = "ARRAY/1, X, SIZE=2\nARRAY/2, Y, SIZE=1\nARRAY/3, U, SIZE=1, VARIABLES=5\nVARIABLE/5, FUNCTION=TIME\nGSE/4, NS=2, NO=1, X=1, Y=2, U=3"
PUSHES = "".join(f"SFORCE/{k}, TRANSLATION, ACTIONONLY, I=21, J=10, FUNCTION={k}\n" for k in (2, 4, 8))
SPHERES = """MARKER/31, PART=2, QP=0,0,995
MARKER/32, PART=2, QP=0,500,995
GRAPHICS/11, PLANE, RM=10, XMIN=-9, XMAX=9, YMIN=-9, YMAX=9
GRAPHICS/31, ELLIPSOID, CM=31, XSCALE=2000, YSCALE=2000, ZSCALE=2000
GRAPHICS/32, ELLIPSOID, CM=32, XSCALE=2000, YSCALE=2000, ZSCALE=2000
"""
LAW = "STIFFNESS=1E3, DAMPING=0, EXPONENT=1, DMAX=0.1"
FALLS = "SIMULATE/DYNAMICS, END=0.001, STEPS=1\n"
DATASETS: dict[str, tuple[str, str, float, str]] = {
    "zero bytes in a STRING": ("STRING/7, STRING=a\0b\n", "", -G, ""),
    "zero bytes in graphics": ("GRAPHICS/9, CIRCLE, CM=\0\n", "", -G, ""),
    "zero bytes in a comment": ("! \0\n", "", -G, ""),
    "GSE that nothing reads": (f"{GSE}\n", "", -G, "GSE (line"),
    "CONTACT of TYPE=SOLID_TO_SOLID": (f"{SPHERES}CONTACT/1, TYPE=SOLID_TO_SOLID, IGEOM=31, JGEOM=11, {LAW}\n", "", 2500 - G, ""),
    "CONTACT with a list IGEOM": (f"{SPHERES}CONTACT/1, IGEOM=31, 32, JGEOM=11, {LAW}\n", "", 5000 - G, ""),
    "CONTACT with a list JGEOM": (f"{SPHERES}CONTACT/1, IGEOM=11, JGEOM=31, 32, {LAW}\n", "", 5000 - G, ""),
    "friction that rests in statics": (HELD.replace("FIXED", "SPHERICAL") + "FRICTION/1, JOINT=1, MU_STATIC=0.2, MU_DYNAMIC=0.1, INACTIVE_DURING=STATIC, BALL_RADIUS=1\n", "", 0.0, ""),
    "PD of a joint": (HELD + "JOINT/2, SPHERICAL, I=21, J=10, PD=4\n", "", 0.0, "JOINT PD of JOINT/2"),
    "DEACTIVATE/JOINT": (HELD, "DEACTIVATE/JOINT, ID=1\n", -G, ""),
    "a range of forces": (PUSHES, "DEACTIVATE/SFORCE, RANGE=3,8\n", 1 - G, ""),
    "a range with gaps": (PUSHES, "DEA/SFORCE, RANGE=1,4\n", 4 - G, ""),
    "a range made active again": (PUSHES, "DEA/SFORCE, RANGE=2,8\nACT/SFORCE, RANGE=4,5\n", 2 - G, ""),
    "an ID and a range": (PUSHES, "DEA/SFORCE, ID=2, RANGE=8,9\n", 2 - G, ""),
    "ENVIRONMENT": (PUSHES, "ENVIRONMENT/NAME=A, VALUE=B\n", 7 - G, "ENVIRONMENT (line 1)"),
    "LINEAR/EIGENSOL": (PUSHES, "LINEAR/EIGENSOL\n", 7 - G, "'stiffmbs modes'"),
    "LINEAR/STATEMAT": (PUSHES, "LIN/STATEMAT, FILE=abc, PINPUT=1, POUTPUT=2\n", 7 - G, "'stiffmbs response'"),
}  # fmt: skip
"""Statements, commands, the acceleration along z at the start, and a note."""
COMMANDS: dict[str, tuple[dict[str, str], float]] = {
    "FILE/COMMAND=other.acf": ({"other.acf": "SIM/DYN, END=1, STEPS=2\nSTOP\n"}, 1.0),
    "FIL/COM=other": ({"other.acf": "FILE/COMMAND=third.acf\n", "third.acf": "SIM/DYN, END=2, STEPS=2\nSTOP\n"}, 2.0),
    "FILE/MODEL=a, COMMAND=other.acf": ({"other.acf": "INTEGRATOR/HMAX=0.1\n"}, 3.0),
    "file/command = other.acf": ({"other.acf": "SIM/DYN, END=1, STEPS=2\n"}, 3.0),
}
"""A command before END=3, files, and the end of the run."""
FAULTY: dict[str, tuple[str, dict[str, str], str]] = {
    "no such file": ("FILE/COMMAND=no.acf\n", {}, "no.acf: found no such file"),
    "a file within itself": ("FILE/COMMAND=o.acf\n", {"o.acf": "FILE/COMMAND=o.acf\n"}, "FILE/COMMAND: o.acf, line 1, FILE/COMMAND: found COMMAND = o.acf, expected no file that executes itself"),
    "a command that is not followed": ("FILE/COMMAND=o.acf\n", {"o.acf": "BOX/1\n"}, "BOX/1: found an unsupported command"),
    "a range of nothing": ("DEACTIVATE/SFORCE, RANGE=20,30\n", {}, "found no SFORCE from"),
}  # fmt: skip
SCENES: dict[str, tuple[str, float]] = {
    "dimensions: 3\ngravity: [0, 0, -2]\n": ("bodies: {b: {mass: 1, inertia: [1, 1, 1]}}\n", -2.0),
    "dimensions: 3\n": ("bodies: {b: {mass: 4, inertia: [1, 1, 1]}}\nforces: {f: {type: force, i: b, force: [0, 0, 8]}}\n", 2.0),
    "dimensions: 3\ngravity: [1, 2, 3]\n": ("bodies: {b: {mass: 1, inertia: [1, 1, 1]}}\njoints: {h: {type: spherical, i: b, j: ground}}\n", 0.0),
}  # fmt: skip


def _followed(name: str, folder: Path) -> Verdict:
    statements, commands, expected, note = DATASETS[name]
    (folder / "m.adm").write_bytes(f"{HEAD}{statements}END\n".encode("latin-1"))
    (folder / "m.acf").write_text(commands + FALLS, encoding="utf-8")
    scene = load_scene(folder / "m.adm")
    error, notes = abs(float(run(scene)["PART_2.az"][0]) - expected) / max(1.0, abs(expected)), "; ".join(scene.notes)
    return told(notes, (note,), error, ALLOWED) if note else measured(error, ALLOWED, notes)


def _until(command: str, folder: Path) -> float:
    (folder / "m.acf").write_text(f"{command}\nSIMULATE/DYNAMICS, END=3, STEPS=2\n", encoding="utf-8")
    return abs(float(run(load_scene(folder / "m.adm")).t[-1]) - COMMANDS[command][1])


def _written(head: str) -> Verdict:
    body, expected = SCENES[head]
    text = dataset_text(cast(SpatialData, read_scene(head + body)))
    statements = [line for line in text.splitlines()[1:] if not line.startswith((",", "!", "END"))]
    bare = [line for line in statements if not re.match(r"[A-Z]+/", line)]
    if bare or not any(line.startswith("UNITS/") for line in statements):
        return Verdict(Outcome.WRONG, detail=f"statements without a slash: {bare}")
    again = run(read_adams(text), duration=1e-6, points=2)
    return measured(abs(float(next(again[name][0] for name in again if name.endswith(".az"))) - expected), ALLOWED)


CASES = (
    *(
        Case(name, "the acceleration by hand, and a note", partial(with_files, {}, partial(_followed, name)), Outcome.TOLD if note else Outcome.RIGHT)
        for name, (_, _, _, note) in DATASETS.items()
    ),
    *(
        compared(f"command {name}", "the end of the run", partial(with_files, files | {"m.adm": f"{HEAD}END\n"}, partial(_until, name)), 0.0)
        for name, (files, _) in COMMANDS.items()
    ),
    *(
        refused(name, "its file and line", partial(with_files, files | {"m.adm": f"{HEAD}END\n", "m.acf": text}, lambda folder: load_scene(folder / "m.adm")), "m.acf, line 1", words)
        for name, (text, files, words) in FAULTY.items()
    ),
    *(Case(f"written: {' '.join(head.split())}", "a slash in each statement", partial(_written, head)) for head in SCENES),
)  # fmt: skip
