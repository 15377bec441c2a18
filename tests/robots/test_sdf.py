"""SDFormat files: frames, joints and masses by an independent evaluation, and the same robot as URDF."""

from xml.etree import ElementTree

import numpy as np
import pytest
import yaml

import stiffmbs
from stiffmbs.robots.load import convert_robot, load_robot
from tests.random_trees import tree_in_urdf

from .sdf_files import FrameGraph, of_urdf


def written(tmp_path, text, name="robot.sdf"):
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def by_quaternion(p):
    """Rotation matrix of a quaternion w, x, y, z."""
    w, *v = p
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def placed(entry):
    """Rotation matrix and origin of a body or marker of a scene."""
    at = entry.get("position") or entry.get("point") or [0, 0, 0]
    return by_quaternion(entry.get("orientation", [1, 0, 0, 0])), np.array(at, dtype=float)


@pytest.mark.parametrize("seed", range(40))
def test_frames_of_a_random_graph(tmp_path, seed):
    """Poses in links, joints, frames and nested models by matrices, with placement frames and all forms of rotation."""
    graph = FrameGraph(np.random.default_rng(seed), depth=2)
    scene = yaml.safe_load(convert_robot(written(tmp_path, graph.text)))
    bodies = {name.replace("::", "__"): M for name, M in graph.links.items()}
    assert scene["bodies"].keys() == bodies.keys()
    for name, M in bodies.items():
        turn, at = placed(scene["bodies"][name])
        np.testing.assert_allclose(turn, M[:3, :3], atol=1e-12)
        np.testing.assert_allclose(at, M[:3, 3], atol=1e-12)
    joints = {name.replace("::", "__"): at for name, at in graph.axes.items()}
    assert scene.get("joints", {}).keys() == joints.keys()
    for name, (point, axis) in joints.items():
        for end in "ij":
            body, marker = scene["joints"][name][end].split(".")
            turn, at = placed(scene["bodies"][body]["markers"][marker])
            body_turn, body_at = placed(scene["bodies"][body])
            np.testing.assert_allclose(body_at + body_turn @ at, point, atol=1e-12)
            np.testing.assert_allclose((body_turn @ turn)[:, 2], axis, atol=1e-12)


@pytest.mark.parametrize("version", [(1, 4), (1, 5), (1, 6), (1, 7), (1, 9), (1, 12)])
@pytest.mark.parametrize("seed", range(3))
def test_a_tree_has_the_accelerations_of_the_same_tree_in_urdf(tmp_path, version, seed):
    rng = np.random.default_rng(seed)
    urdf = tree_in_urdf(rng)
    paths = written(tmp_path, urdf, "tree.urdf"), written(tmp_path, of_urdf(ElementTree.fromstring(urdf), rng, version))
    names = [joint.get("name") for joint in ElementTree.fromstring(urdf).findall("joint")]
    state = {"coordinates": dict(zip(names, rng.uniform(-1, 1, len(names)), strict=True)),
             "rates": dict(zip(names, rng.normal(size=len(names)), strict=True))}  # fmt: skip
    runs = []
    for path in paths:
        scene = load_robot(path, [(f"inputs.{name}_input", str(k - 2)) for k, name in enumerate(names)], **state)
        runs.append(stiffmbs.run(scene, duration=1e-6, output=1e-6, rtol=1e-10))
    channels = [f"link{k}.{a}" for k in range(6) for a in ("ax", "ay", "az", "wdx", "wdy", "wdz")]
    urdf_found, sdf_found = (np.array([run[channel][0] for channel in channels]) for run in runs)
    np.testing.assert_allclose(sdf_found, urdf_found, rtol=0, atol=1e-12 * np.abs(urdf_found).max())
