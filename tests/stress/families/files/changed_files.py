"""Files that a scene names: once one has changed, a study's store names it, and studies in the same process follow it."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stiffmbs import __file__ as package
from stiffmbs.errors import StiffmbsError
from stiffmbs.studies.sweep import sweep

from ...case import Case, Outcome, Verdict, told
from ...variants.answers import with_files

WHEEL = """
dimensions: 3
roads: {{field: {road}}}
bodies: {{b: {{mass: 100, inertia: [1, 1, 1], position: [2, 5, 0.29], geometry: [{mesh}]}}}}
forces: {{tyre: {tyre}}}
run: {{duration: 1 us, points: 2}}
"""
VERTICAL = "{type: vertical_tyre, i: b, radius: 0.3, stiffness: 1e5, damping: 2000, road: field}"
MAGIC = "{type: magic_formula_tyre, i: b, properties: car.tir, road: field}"
FLAT = "{type: flat}"
GRID = "4 6\n{0} {0} {0}\n10 {0} {0}\n"
CRG = "$ROAD_CRG\nreference_line_increment=1\n$\n$KD_DEFINITION\n#:LRFI\nD:long section at v = -9,m\nD:long section at v = 9,m\n$\n$$$$\n"
MOVING = "bodies: {{{0}: {{mass: 2, inertia: 1, velocity: [{1}, 0]}}}}\n"
RUN = "run: {duration: 1, points: 2}\n"
DATASET = """falls
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
PART/2, MASS=1, CM=3, IP=1,1,1
MARKER/3, PART=2
ACCGRAV/KGRAV=-10
END
"""
STL = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 {0}\nvertex 1 0 {0}\nvertex 0 1 {0}\nendloop\nendfacet\nendsolid s\n"


def wheel(road: str = FLAT, mesh: str = "", force: str = VERTICAL) -> dict[str, str]:
    """Return the scene of a wheel that a road presses by 10 mm."""
    return {"scene.yaml": WHEEL.format(road=road, mesh=mesh, tyre=force)}


def curved_grid(height: float) -> str:
    """Return an OpenCRG file of constant height."""
    return CRG + f"{height:10.5f}{height:10.5f}\n" * 20


def tyre(stiffness: float) -> str:
    """Return the tyre of the examples, which has a radius of its own, with another stiffness."""
    text = (Path(package).parent.parent / "examples" / "car.tir").read_text(encoding="utf-8")
    lines = [f"VERTICAL_STIFFNESS = {stiffness}" if line.startswith("VERTICAL_STIFFNESS") else line for line in text.splitlines()]  # fmt: skip
    return "\n".join(lines) + "\n"


KINDS: dict[str, tuple[dict[str, str], str, tuple[str, str], str, tuple[float, float]]] = {
    "tyre": (wheel(force=MAGIC), "car.tir", (tyre(2e5), tyre(1e5)), "final(tyre.fz)", (0.026 * 2e5, 0.026 * 1e5)),
    "grid": (wheel("{type: grid, file: g.txt}"), "g.txt", (GRID.format(0), GRID.format(0.01)), "final(tyre.fz)", (1e3, 2e3)),
    "grid with other ground": (wheel("{type: grid, file: g.txt}"), "g.txt", (GRID.format(-0.1), GRID.format(0.0)), "final(tyre.fz)", (0, 1e3)),
    "OpenCRG": (wheel("{type: crg, file: r.crg}"), "r.crg", (curved_grid(0.0), curved_grid(0.01)), "final(tyre.fz)", (1e3, 2e3)),
    "include": ({"scene.yaml": "include: m.yaml\nbodies: {b: {mass: 1, inertia: 1}}\n" + RUN}, "m.yaml", ("gravity: [0, -1]\n", "gravity: [0, -2]\n"), "final(b.y)", (-0.5, -1)),
    "include of an include": ({"scene.yaml": "include: m.yaml\n" + RUN, "m.yaml": "include: n.yaml\n"}, "n.yaml", (MOVING.format("b", 1), MOVING.format("b", 2)), "final(b.x)", (1, 2)),
    "include of a part": ({"scene.yaml": "parts: {leg: {include: l.yaml}}\nuse: {b: {part: leg}}\n" + RUN}, "l.yaml", (MOVING.format("foot", 1), MOVING.format("foot", 3)), "final(b.foot.x)", (1, 3)),
    "OBJ mesh": (wheel(mesh="{type: mesh, file: w.obj}"), "w.obj", ("v 0 0 0\n", "v 0 0 1\n"), "final(tyre.fz)", (1e3, 1e3)),
    "STL mesh": (wheel(mesh="{type: mesh, file: w.stl}"), "w.stl", (STL.format(0), STL.format(1)), "final(tyre.fz)", (1e3, 1e3)),
    "commands of a dataset": ({"scene.adm": DATASET}, "scene.acf", ("SIM/DYN, END=1, STEPS=1\n", "SIM/DYN, END=2, STEPS=1\n"), "final(PART_2.z)", (-5, -20)),
    "commands of commands": ({"scene.adm": DATASET, "scene.acf": "FILE/COMMAND=o.acf\n"}, "o.acf", ("SIM/DYN, END=1, STEPS=1\n", "SIM/DYN, END=2, STEPS=1\n"), "final(PART_2.z)", (-5, -20)),
    "the dataset": ({"scene.acf": "SIM/DYN, END=1, STEPS=1\n"}, "scene.adm", (DATASET, DATASET.replace("-10", "-20")), "final(PART_2.z)", (-5, -10)),
    "the scene": ({}, "scene.yaml", (MOVING.format("b", 1) + RUN, MOVING.format("b", 2) + RUN), "final(b.x)", (1, 2)),
}  # fmt: skip
"""The files that stay, the one that changes with its contents, an output, and its closed forms."""


ALLOWED = 1e-3
"""Relative error: a wheel moves within a microsecond too."""


def _judged(kind: str, folder: Path) -> Verdict:
    others, name, contents, of, expected = KINDS[kind]
    scene = folder / ("scene.adm" if "scene.adm" in {*others, name} else "scene.yaml")
    study: dict[str, Any] = {"vary": {"run.rtol": [1e-7, 1e-8]}, "outputs": [of]}
    found = []
    for text in contents:
        (folder / name).write_text(text, encoding="utf-8")
        found += [float(x) for x in sweep(scene, **study)[of]]
        try:
            again = sweep(scene, **study, store=folder / "rows")
        except StiffmbsError as refusal:
            message = str(refusal)
        else:
            message = f"the store gives {again[of].values}"
    error = max(abs(x - wanted) / max(abs(wanted), 1) for x, wanted in zip(found, np.repeat(expected, 2), strict=True))
    changed = "the scene" if name == "scene.yaml" or scene.suffix == ".adm" else f"{name}' had"
    return told(message, ("rows of another study", changed), error, ALLOWED)


CASES = tuple(
    Case(
        kind,
        "closed forms by both contents, and the name of the file",
        partial(with_files, KINDS[kind][0], partial(_judged, kind)),
        Outcome.TOLD,
    )
    for kind in KINDS
)
