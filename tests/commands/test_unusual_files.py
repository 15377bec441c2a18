"""What is no regular file, or has no end, is refused where a scene or command names it: nothing is read without bound."""

import os
import resource
import subprocess
import sys

import pytest

from tests.studies.test_changed_files import FLAT, VERTICAL, WHEEL

SPARSE = 600_000_000
KINDS = ("device", "pipe", "folder", "huge")
ROBOT = "<mujoco><asset><mesh name='m' file='{}'/></asset><worldbody><body><joint/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>"
CART = "bodies: {b: {mass: 1, inertia: 1}}\nrun: {duration: 0.01, points: 2}\n"


def placed(kind, path):
    """Put an unusual file at a path."""
    if kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        with path.open("wb") as file:
            file.truncate(SPARSE)


USES = {
    "scene": ("x.yaml", "", ["run", "x.yaml"]),
    "dataset": ("x.adm", "", ["run", "x.adm"]),
    "robot": ("x.urdf", "", ["run", "x.urdf"]),
    "mjcf": ("x.xml", "", ["run", "x.xml"]),
    "include": ("x.yaml", "include: x.yaml\n", ["run", "scene.yaml"]),
    "tyre": ("x.tir", WHEEL.format(road=FLAT, mesh="", tyre="{type: magic_formula_tyre, i: wheel, properties: x.tir, road: field}"),
             ["run", "scene.yaml"]),
    "grid": ("x.txt", WHEEL.format(road="{type: grid, file: x.txt}", mesh="", tyre=VERTICAL), ["check", "scene.yaml"]),
    "crg": ("x.crg", WHEEL.format(road="{type: crg, file: x.crg}", mesh="", tyre=VERTICAL), ["run", "scene.yaml"]),
    "mesh": ("x.stl", WHEEL.format(road=FLAT, mesh="{type: mesh, file: x.stl}", tyre=VERTICAL), ["draw", "scene.yaml", "-o", "o.json"]),
    "state npz": ("x.npz", CART, ["run", "scene.yaml", "--from", "x.npz"]),
    "state csv": ("x.csv", CART, ["run", "scene.yaml", "--from", "x.csv"]),
    "state nc": ("x.nc", CART, ["run", "scene.yaml", "--from", "x.nc"]),
    "diff": ("x.csv", CART, ["diff", "x.csv", "x.csv"]),
    "diff xml": ("x.res", CART, ["diff", "x.res", "x.res"]),
    "diff map": ("x.map", CART, ["diff", "x.csv", "x.csv", "--map", "x.map"]),
    "plot": ("x.npz", CART, ["plot", "x.npz"]),
    "fit": ("x.csv", CART, ["fit", "scene.yaml", "--data", "x.csv", "--parameter", "bodies.b.mass=0.5:2"]),
    "store": ("o.nc.study", CART, ["study", "scene.yaml", "--vary", "bodies.b.mass=1,2", "-o", "o.nc"]),
    "results": ("o.npz", CART, ["run", "scene.yaml", "-o", "o.npz"]),
}  # fmt: skip
"""The unusual file, the scene that names it, and a command."""
MAY_WORK = {("results", "pipe"), ("results", "device"), ("results", "huge"), ("mesh", "folder")}


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (6_000_000_000, 6_000_000_000))


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("use", USES)
@pytest.mark.sampled(15)
def test_unusual_files_are_refused(tmp_path, use, kind):
    if (use, kind) in MAY_WORK:
        pytest.skip("what is written to may be any file")
    name, scene, command = USES[use]
    (tmp_path / "scene.yaml").write_text(scene)
    placed(kind, tmp_path / name)
    done = subprocess.run(
        [sys.executable, "-m", "stiffmbs", *command], cwd=tmp_path, capture_output=True, text=True, timeout=100,
        preexec_fn=limited, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert "Traceback" not in done.stderr, done.stderr
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert len(done.stderr.strip().splitlines()) == 1


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_meshes_of_mjcf_are_refused(tmp_path, kind):
    pytest.importorskip("mujoco")
    (tmp_path / "scene.xml").write_text(ROBOT.format("x.stl"))
    placed(kind, tmp_path / "x.stl")
    done = subprocess.run(
        [sys.executable, "-m", "stiffmbs", "run", "scene.xml"], cwd=tmp_path, capture_output=True, text=True, timeout=60,
        preexec_fn=limited, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 2, (done.returncode, done.stderr[-500:])


@pytest.mark.long
def test_standard_input_has_an_end():
    with open("/dev/zero", "rb") as zeros:
        done = subprocess.run(
            [sys.executable, "-m", "stiffmbs", "check", "-"], stdin=zeros, capture_output=True, text=True, timeout=60
        )
    assert done.returncode == 2
    assert "standard input: found more than 500000000 bytes" in done.stderr
