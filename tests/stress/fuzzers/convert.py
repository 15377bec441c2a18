"""Compare random scenes, converted to datasets and back, with themselves, and random robot files with MuJoCo."""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from stiffmbs.adams.export.dataset_text import dataset_text
from stiffmbs.adams.load import read_adams
from stiffmbs.adams.statements.dataset import read_dataset
from stiffmbs.analyses.in_space import in_space
from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError, needs
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.spatial_scene import SpatialScene
from stiffmbs.results.solution import Solution
from stiffmbs.robots.load import load_robot
from stiffmbs.robots.scene import joints
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict, measured
from ..random_scenes.features import Features
from ..random_scenes.robots import random_mjcf, random_urdf
from ..random_scenes.scene import random_scene

WHAT = "Random scenes converted to datasets and back, and random MJCF and URDF files against MuJoCo's accelerations."
EXPORTED = ("force", "torque", "line_force", "spring_damper", "torsion_spring", "bushing", "field", "beam")
"""Forces that a dataset can express; others are removed from a scene."""
WITHOUT = Features(friction=False, tyres=False, parts=False, events=False)
TOLERANCES = 1e-8, 1e-11
"""Of a first pair of runs, and of a second one where those differ: an error of integration becomes less."""
ALIKE = 1e-4
"""Allowed difference relative to the size of a channel."""
ROUNDING = 1e-6
"""Allowed error of accelerations relative to the largest one, apart from that of small masses between the joints of one link."""
LIGHTER = 0.1
"""Factor of these masses by which their error, proportional to them, is recognised."""
INSTANT = 1e-6
"""Duration, s, of a run of which only the start is used."""
_NAMED = re.compile(r"\b(joints|forces|states)\.(\w+)")


def trial(seed: int) -> Verdict:
    """Test a random scene, or an MJCF or URDF file."""
    rng = np.random.default_rng(seed)
    kind = rng.choice(["scene", "scene", "mjcf", "urdf"])
    return _converted(rng) if kind == "scene" else _robot(rng, str(kind))


def _converted(rng: np.random.Generator) -> Verdict:
    """Compare a scene with its dataset: centres of mass, their velocities, and angular speeds."""
    content = random_scene(rng, features=WITHOUT)
    content["forces"] = {name: x for name, x in content.get("forces", {}).items() if x["type"] in EXPORTED}
    try:
        spatial, written, text = _written(content)
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))
    again = read_adams(written)
    names = {part.alias: part.label.replace("/", "_") for part in read_dataset(written).parts if not part.ground}
    pairs = {body: names[body] for body in spatial.bodies}
    verdict = _compared(spatial, again, pairs, content["run"]["duration"], TOLERANCES[0], text)
    if verdict.outcome is Outcome.WRONG:
        verdict = _compared(spatial, again, pairs, content["run"]["duration"], TOLERANCES[1], text)
    return verdict


def _compared(spatial: Any, again: Any, names: dict[str, str], duration: float, rtol: float, text: str) -> Verdict:
    """Compare the runs of two scenes whose bodies have different names."""
    settings: dict[str, Any] = {"duration": duration, "points": 11, "rtol": rtol}
    try:
        one, other = run(spatial, **settings), run(again, **settings)
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))
    if Ending.DONE not in (one.outcome, other.outcome):
        return Verdict(Outcome.TOLD, detail=one.message)
    if one.outcome is not other.outcome:
        return Verdict(Outcome.WRONG, detail=f"one of both runs stopped: {one.message}; {other.message} [{text}]")
    return _alike(names, one, other, text)


def _written(content: dict[str, Any]) -> tuple[Any, str, str]:
    """Return a spatial scene, as a scene and as a dataset, without elements that have no statement."""
    while True:
        text = json.dumps(content)
        scene = read_scene(text)
        spatial: Any = scene if isinstance(scene, SpatialScene) else in_space(scene)  # type: ignore[call-overload]
        try:
            return spatial, dataset_text(spatial), text
        except StiffmbsError as refusal:
            refused = {
                (section, name) for section, name in _NAMED.findall(str(refusal)) if name in content.get(section, {})
            }
            if not refused:
                raise
            for section, name in refused:
                del content[section][name]


def _alike(names: dict[str, str], one: Solution, other: Solution, text: str) -> Verdict:
    """Compare the motions of bodies with different names in two runs."""
    worst, where = 0.0, ""
    for body, its in names.items():
        for what in ("x y z", "vx vy vz", "w"):
            pair = [_of_body(solution, name, what) for solution, name in ((one, body), (other, its))]
            error = float(np.max(np.abs(pair[0] - pair[1])) / max(np.max(np.abs(pair[0])), 1.0))
            if not error <= worst:
                worst, where = error, f"{what} of {body}"
    return measured(worst, ALIKE, f"{where} [{text}]")


def _of_body(solution: Solution, body: str, what: str) -> np.ndarray:
    """Return position, velocity, or the magnitude of the angular velocity, which does not depend on body axes."""
    if what == "w":
        return np.linalg.norm([solution[f"{body}.w{axis}"] for axis in "xyz"], axis=0)
    return np.array([solution[f"{body}.{name}"] for name in what.split()])


def _robot(rng: np.random.Generator, kind: str) -> Verdict:
    """Compare the accelerations of all centres of mass at a random state with MuJoCo's."""
    with needs("mujoco", "robots"):
        import mujoco
    text = random_mjcf(rng) if kind == "mjcf" else random_urdf(rng)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"robot.{'xml' if kind == 'mjcf' else 'urdf'}"
        path.write_text(text)
        m = mujoco.MjModel.from_xml_path(str(path))
        d = mujoco.MjData(m)
        coordinates, rates = {}, {}
        for k in range(m.njnt):
            if m.jnt_type[k] in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
                name = m.joint(k).name
                coordinates[name], rates[name] = float(rng.uniform(-0.6, 0.6)), float(rng.normal())
                d.qpos[m.jnt_qposadr[k]], d.qvel[m.jnt_dofadr[k]] = coordinates[name], rates[name]
        d.ctrl[:] = rng.uniform(-1, 1, m.nu)
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
        mujoco.mj_forward(m, d)
        known = load_robot(path).inputs
        inputs = {f"{m.actuator(k).name}_input": float(d.ctrl[k]) for k in range(m.nu)}
        changes = [(f"inputs.{name}", repr(u)) for name, u in inputs.items() if name in known]
        wanted = {m.body(k).name: _acceleration(mujoco, m, d, k) for k in range(1, m.nbody)}

        def errors() -> dict[str, float]:
            return _errors(load_robot(path, changes, coordinates=coordinates, rates=rates), wanted)

        found = errors()
        worst = max(found, key=found.__getitem__)
        detail = f"{worst} of {text}"
        if found[worst] > ROUNDING:
            with patch.object(joints, "MASSLESS", LIGHTER * joints.MASSLESS):
                lighter = errors()[worst]
            if lighter <= 2 * LIGHTER * found[worst]:
                return Verdict(Outcome.RIGHT, found[worst], ROUNDING, f"small masses between joints: {detail}")
    return measured(found[worst], ROUNDING, detail)


def _errors(scene: Any, wanted: dict[str, np.ndarray]) -> dict[str, float]:
    """Return the errors of the accelerations at the start by body, relative to the largest acceleration."""
    solution = run(scene, duration=INSTANT, output=INSTANT, rtol=1e-10)
    found = {
        name: np.array([solution[f"{name}.a{axis}"][0] for axis in "xyz"]) for name in wanted if name in scene.bodies
    }
    size = max(1.0, *(float(np.max(np.abs(wanted[name]))) for name in found))
    return {name: float(np.max(np.abs(found[name] - wanted[name]))) / size for name in found}


def _acceleration(mujoco: Any, m: Any, d: Any, body: int) -> np.ndarray:
    """Return the acceleration of a centre of mass by MuJoCo, m/s^2: J q'' + J' q'."""
    J, rate = np.zeros((3, m.nv)), np.zeros((3, m.nv))
    mujoco.mj_jac(m, d, J, None, d.xipos[body], body)
    mujoco.mj_jacDot(m, d, rate, None, d.xipos[body], body)
    return np.asarray(J @ d.qacc + rate @ d.qvel)
