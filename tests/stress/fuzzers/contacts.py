"""Random bodies that meet each other, walls, stops and bumps of laws over distance, mostly within one step."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict, measured
from ..tiny_steps import ARCH, CIRCLES, GATE, GAUSSIAN, LAW, LINE, LORENTZ, STOP, TENT, WINDOW, Scene, moved

WHAT = (
    "free bodies under contacts, stops and bumps of laws over distance, against Runge-Kutta steps of five microseconds"
)
STEP, COARSE, CHANGE = 5e-6, 2e-5, 1e-7
WITHIN, SENSITIVE, CHAOTIC = 1e-3, 1e3, 0.05
"""Error that is right beside the motion's size; tolerances by which a start may differ from it; sensitivity that says nothing."""
SOLVERS: tuple[dict[str, Any], ...] = (
    {"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "projected", "scheme": "dopri5"}, {"solver": "auto"},
)  # fmt: skip


def trial(seed: int) -> Verdict:
    """One random scene by a random solver."""
    rng = np.random.default_rng(seed)
    described, scene = _made(rng)
    duration, points, rtol = float(rng.uniform(0.3, 0.7)), int(rng.choice([2, 5, 40])), 10.0 ** -rng.integers(6, 9)
    how = SOLVERS[rng.integers(len(SOLVERS))]
    true = moved(scene, duration, points, STEP)
    size = float(max(1e-3, np.abs(true[:, :, :2]).max()))
    one, other = (moved(scene, duration, points, COARSE, change) for change in (0.0, CHANGE))
    sensitivity = float(np.abs(one - other)[:, :, :2].max() / CHANGE)
    settings = f"seed {seed}, {how.get('scheme', how['solver'])}, rtol {rtol:.0e}"
    try:
        solution = run(read_scene(json.dumps(described)), duration=duration, points=points, rtol=rtol, **how)
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=f"{settings}: {refusal}")
    if solution.outcome is not Ending.DONE:
        return Verdict(Outcome.TOLD, detail=f"{settings}: {solution.message}")
    found = np.stack([[solution[f"b{k}.{axis}"] for axis in "xy"] for k in range(len(scene.mass))])
    error = float(np.abs(found - np.moveaxis(true[:, :, :2], 0, -1)).max())
    allowed = WITHIN * size + SENSITIVE * rtol * size * sensitivity
    if allowed > CHAOTIC * size:
        return Verdict(Outcome.RIGHT, error, allowed, f"{settings}: too sensitive to be judged")
    return measured(error, allowed, settings)


def _made(rng: np.random.Generator) -> tuple[dict[str, Any], Scene]:
    """The same scene for the package and by hand."""
    count = int(rng.integers(1, 4))
    gravity = np.array([0.0, -9.81]) if rng.random() < 0.5 else np.zeros(2)
    mass, inertia = 10 ** rng.uniform(-1, 1, count), 10 ** rng.uniform(-3, -1, count)
    spins = rng.choice([0.0, 1.0, 30.0, 200.0], count) * rng.uniform(-1, 1, count)
    start = np.column_stack(
        [np.arange(count), rng.uniform(-0.05, 0.05, count), rng.uniform(-3, 3, count), rng.uniform(-5, 5, (count, 2)), spins]
    )  # fmt: skip
    bodies = {
        f"b{k}": {
            "mass": mass[k], "inertia": inertia[k], "position": list(start[k, :2]), "angle": start[k, 2],
            "velocity": list(start[k, 3:5]), "omega": start[k, 5],
        }
        for k in range(count)
    }  # fmt: skip
    forces: dict[str, Any] = {}
    tables: dict[str, Any] = {}
    rows: list[list[float]] = []
    for n in range(int(rng.integers(1, 4))):
        of_kind = (_wall, _circles, _law, _stop)[rng.integers(4)]
        forces[f"f{n}"], table, row = of_kind(rng, int(rng.integers(count)), start)
        tables |= table
        rows.append([*map(float, row), *[0.0] * (12 - len(row))])
    described = {"gravity": list(gravity), "bodies": bodies, "tables": tables, "forces": forces}
    return described, Scene(mass, inertia, start, gravity, np.array(rows))


Force = tuple[dict[str, Any], dict[str, Any], list[float]]
"""A force as a scene has it, its tables, and its numbers by hand."""


def _wall(rng: np.random.Generator, i: int, start: np.ndarray) -> Force:
    point, angle = rng.uniform(-0.1, 0.1, 2), rng.uniform(-np.pi, np.pi)
    k, exponent, chi = 10 ** rng.uniform(5, 8), rng.choice([1.0, 1.5, 2.0]), rng.choice([0.0, 0.2])
    wall = start[i, :2] - rng.uniform(0.3, 1.0) * np.array([np.cos(angle), np.sin(angle)])
    ground = {"body": "ground", "point": list(wall), "angle": angle - np.pi / 2}
    contact = {
        "type": "contact", "i": {"body": f"b{i}", "point": list(point)}, "j": ground, "stiffness": k, "exponent": exponent, "dissipation": chi,
    }  # fmt: skip
    return contact, {}, [LINE, i, *point, *wall, angle, k, exponent, chi]


def _circles(rng: np.random.Generator, i: int, start: np.ndarray) -> Force:
    k, exponent = 10 ** rng.uniform(5, 8), rng.choice([1.0, 1.5, 2.0])
    small, large = rng.uniform(0.01, 0.1, 2)
    contact = {"type": "contact", "i": f"b{i}", "radius": small, "stiffness": k, "exponent": exponent}
    j = int(rng.integers(len(start)))
    if j != i:
        contact |= {"j": f"b{j}", "surface": "circle", "surface_radius": large}
        return contact, {}, [CIRCLES, i, j, 0, 0, small + large, 1, k, exponent]
    if rng.random() < 0.3:
        centre, large = start[i, :2] + rng.uniform(-0.1, 0.1, 2), 0.5 + 3 * large
        contact |= {"j": {"body": "ground", "point": list(centre)}, "surface": "hole", "surface_radius": large}
        return contact, {}, [CIRCLES, i, -1, *centre, small - large, -1, k, exponent]
    centre = start[i, :2] + rng.uniform(0.2, 0.6, 2)
    contact |= {"j": {"body": "ground", "point": list(centre)}, "surface": "circle", "surface_radius": large}
    return contact, {}, [CIRCLES, i, -1, *centre, small + large, 1, k, exponent]


def _law(rng: np.random.Generator, i: int, start: np.ndarray) -> Force:
    """A bump over a coordinate, which the body reaches on its way."""
    over, along, bump, width = (*map(int, rng.integers([2, 2, 6])), 10 ** rng.uniform(-3, -1))
    middle = start[i, over] + rng.uniform(0.2, 1.0) * np.sign(start[i, 3 + over])
    height = rng.choice([-1, 1]) * 10 ** rng.uniform(1, 2.5)
    name = f"tent{int(1e9 * abs(middle))}"
    coordinate = f"b{i}.{'xy'[over]}"
    z = f"(({coordinate} - ({middle:.17g}))/{width:.17g})"
    text = {
        GAUSSIAN: f"exp(-{z}^2)", WINDOW: f"0.5*(tanh({z} + 5) - tanh({z} - 5))", ARCH: f"max(0, 1 - {z}^2)",
        GATE: f"step({z}, -2, 0, -1, 1)*step({z}, 1, 1, 2, 0)", LORENTZ: f"1/(1 + {z}^2)", TENT: f"{name}({coordinate})",
    }[bump]  # fmt: skip
    points = [[middle + width * place, float(place == 0)] for place in (-1e4, -1, 0, 1, 1e4)]
    tables = {name: {"table": points, "lines": True}} if bump == TENT else {}
    row = [LAW, i, over, along, middle, width, height, bump]
    law = f"{height:.17g}*{text}"
    return {"type": "force", "i": f"b{i}", "force": [law, 0] if along == 0 else [0, law]}, tables, row


def _stop(rng: np.random.Generator, i: int, start: np.ndarray) -> Force:
    limit, k = start[i, 2] + rng.uniform(0.1, 2.0), 10 ** rng.uniform(3, 6)
    torque = f"-{k:.17g}*max(0, b{i}.angle - ({limit:.17g}))"
    return {"type": "torque", "i": f"b{i}", "torque": torque}, {}, [STOP, i, limit, k]
