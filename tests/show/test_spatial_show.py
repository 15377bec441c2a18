"""What is shown of motions in space: channels in bodies' own axes, tables, files, and how runs are compared."""

import csv
import io
import json
from importlib.util import find_spec

import numpy as np
import pytest
from click.testing import CliRunner
from rich.console import Console

import stiffmbs
from stiffmbs import spatial
from stiffmbs.commands.main import main
from stiffmbs.elements.spatial.orientation import conjugate, matrix, product, rotated
from stiffmbs.results.scales import scales
from stiffmbs.show.figure import drawn
from stiffmbs.show.force_table import force_rows, rich_table
from stiffmbs.verification.diagnostics import distance, divergence

from ..conftest import EXAMPLES
from ..spatial_closed_forms import matrices

TURN = np.array([0.3, -0.5, 0.7, 0.4])
TURN = tuple(TURN / np.linalg.norm(TURN))
MOMENTS = (0.2, 0.35, 0.45)
STATE = ("x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az")
FORCES = ("fx", "fy", "fz", "tx", "ty", "tz")


def swinging(turn):
    """A lopsided body on a hinge of any direction and beside it a free one, described in axes that are turned."""
    back = conjugate(turn)
    tensor = matrix(back) @ np.diag(MOMENTS) @ matrix(turn)
    own = {"mass": 2.0, "inertia": tensor, "orientation": turn}
    model = spatial.Model("swing", gravity=(1.0, -3.0, -9.0))
    foot = tuple(rotated(back, (-0.4, 0.1, 0.2)))
    axis = product(back, _axis((1.0, 2.0, -0.5)))
    model.add("arm", spatial.Body(**own, position=(0.4, -0.1, -0.2)))
    model.add("free", spatial.Body(**own, position=(0.0, 3.0, 0.0), omega=tuple(rotated(back, (1.0, 4.0, -2.0)))))
    hinge = spatial.Marker(body="arm", point=foot, orientation=axis)
    model.add("hinge", spatial.Revolute(i=hinge, j=spatial.Marker(body="ground", orientation=_axis((1.0, 2.0, -0.5)))))
    return model


def _axis(z):
    return spatial.Marker(body="ground", orientation={"z": z}).orientation


def stacked(solution, body, names):
    return np.stack([solution[f"{body}.{name}"] for name in names])


QUATERNION, OMEGA, TURNING = ("q0", "q1", "q2", "q3"), ("wx", "wy", "wz"), ("wdx", "wdy", "wdz")
SETTINGS = {"duration": 3.0, "points": 301, "rtol": 1e-11, "solver": "projected", "scheme": "dop853"}


def test_the_motion_is_the_same_whatever_axes_a_body_is_described_in():
    plain, turned = (stiffmbs.run(swinging(turn), **SETTINGS) for turn in ((1.0, 0.0, 0.0, 0.0), TURN))
    for body in ("arm", "free"):
        for name in STATE:
            np.testing.assert_allclose(turned[f"{body}.{name}"], plain[f"{body}.{name}"], atol=2e-8)
        for names in (OMEGA, TURNING):
            seen = matrix(TURN) @ stacked(turned, body, names)
            np.testing.assert_allclose(seen, stacked(plain, body, names), atol=1e-7)
        of_plain, of_turned = (matrices(stacked(found, body, QUATERNION)) for found in (plain, turned))
        np.testing.assert_allclose(of_turned, of_plain @ matrix(TURN), atol=1e-8)
    for name in FORCES:
        np.testing.assert_allclose(turned[f"hinge.{name}"], plain[f"hinge.{name}"], atol=1e-7)
    np.testing.assert_allclose(turned["energy.total"], plain["energy.total"], atol=1e-7)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_channels_of_rotation_belong_together(solver):
    """Quaternions of length 1 and without jumps of sign, rates as differences show them."""
    settings = {**SETTINGS, "solver": solver, "duration": 2.0, "points": 2001, "rtol": 1e-9}
    found = stiffmbs.run(swinging(TURN), **settings)
    h = found.time[1]
    for body in ("arm", "free"):
        p, w, wd = (stacked(found, body, names) for names in (QUATERNION, OMEGA, TURNING))
        assert np.max(np.abs(np.linalg.norm(p, axis=0) - 1)) < 1e-14
        np.testing.assert_allclose(p[:, 0], TURN, atol=1e-12)
        assert np.max(np.linalg.norm(np.diff(p), axis=0)) < 0.01
        rate = (p[:, 2:] - p[:, :-2]) / (2 * h)
        p0, (p1, p2, p3) = p[0, 1:-1], p[1:, 1:-1]
        E = np.array([[-p1, p0, p3, -p2], [-p2, -p3, p0, p1], [-p3, p2, -p1, p0]])
        np.testing.assert_allclose(2 * np.einsum("ijn,jn->in", E, rate), w[:, 1:-1], atol=2e-4)
        np.testing.assert_allclose((w[:, 2:] - w[:, :-2]) / (2 * h), wd[:, 1:-1], atol=2e-4)


def test_sizes_of_channels_are_those_of_all_directions_and_of_all_that_turns():
    found = stiffmbs.run(swinging(TURN), **SETTINGS)
    sizes = scales(found.channels, 1.0)
    assert sizes["hinge.tx"] == sizes["hinge.tz"] > 0
    assert sizes["free.wx"] == sizes["free.wy"] == pytest.approx(np.max(np.abs(stacked(found, "free", OMEGA))))
    assert sizes["free.q0"] == sizes["free.q3"]
    assert 0.1 < sizes["arm.q0"] <= 2


def test_bodies_that_turn_apart_are_seen_whatever_the_sign_of_their_quaternions():
    t = np.linspace(0, 2, 201)
    still = {f"body.{name}": np.zeros(201) for name in ("x", "y", "z", "q2", "q3", "wy", "wz")}

    def turning(angle, sign=1.0):
        rate = np.gradient(angle, t)
        return {**still, "body.q0": sign * np.cos(angle / 2), "body.q1": sign * np.sin(angle / 2), "body.wx": rate}

    first = turning(2 * t)
    tilted = {**first, "body.q0": first["body.q0"] * np.cos(t), "body.q2": first["body.q0"] * np.sin(t),
              "body.q1": first["body.q1"] * np.cos(t), "body.q3": first["body.q1"] * np.sin(t)}  # fmt: skip
    sizes = scales(first, 1.0)
    for other, expected in (
        (turning(2 * t, -1.0), None),
        (turning(2 * t + 1e-3), None),
        (turning(2 * t + t**2), 0.45),
        (tilted, 0.02),
    ):
        met = divergence(t, distance(first, other, sizes))
        assert met is None if expected is None else met.t == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("width", [50, 80, 120])
def test_names_of_elements_and_numbers_stay_whole_in_narrow_tables(width):
    found = stiffmbs.run(swinging(TURN), **SETTINGS, errors=False)  # a bar shortens its number
    file = io.StringIO()
    Console(file=file, width=width).print(rich_table(*force_rows(found)))
    shown = file.getvalue()
    assert all(len(line) <= width for line in shown.splitlines())
    assert "…" not in shown
    assert "hinge" in shown and "torque" in shown
    for channel in FORCES:
        for end in (np.min, np.max):
            assert f"{end(found[f'hinge.{channel}']):.5g}" in shown


def test_a_request_that_only_rounds_off_is_in_no_doubt():
    text = (EXAMPLES / "heavy_top.yaml").read_text(encoding="utf-8")
    request = "\nrequests: {nothing: (top.z - 0.2*(1 - 2*(top.q1^2 + top.q2^2)))*1e-2}\n"
    found = stiffmbs.verify(stiffmbs.read_scene(text + request), duration=0.5)
    assert np.max(np.abs(found["nothing"])) < 1e-14
    assert scales(found.channels, 1.0)["nothing"] == 0
    assert not found.notes


def test_a_joint_without_torque_has_no_row_for_it():
    found = stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "heavy_top.yaml"), duration=0.2)
    file = io.StringIO()
    Console(file=file, width=80).print(rich_table(*force_rows(found)))
    assert "tip" in file.getvalue() and "torque" not in file.getvalue()


def test_command_writes_all_channels_and_prints_them_as_json(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = str(EXAMPLES / "heavy_top.yaml")
    options = ["--duration", "0.2", "--json"]
    cells = {}
    for ending in ("csv", "npz", *(["nc"] if find_spec("xarray") else [])):
        result = CliRunner().invoke(main, ["run", path, *options, "-o", f"top.{ending}"])
        assert result.exit_code == 0, result.output
        cells = json.loads(result.output)["channels"]
    bodies = [f"top.{name}" for name in (*STATE[:3], *QUATERNION, *STATE[3:6], *OMEGA, *STATE[6:], *TURNING)]
    joints = [f"tip.{name}" for name in FORCES]
    assert [name for name in cells if name.startswith(("top.", "tip."))] == bodies + joints
    with open("top.csv") as file:
        rows = list(csv.reader(file))
    assert [head.partition(" (")[0] for head in rows[0]] == ["time", *cells]
    saved = np.load("top.npz")
    np.testing.assert_array_equal(saved["top.q1"], [float(row[rows[0].index("top.q1")]) for row in rows[1:]])
    assert saved["top.q1"][-1] == cells["top.q1"]["last"]


@pytest.mark.long
def test_a_figure_in_space_is_a_path(tmp_path):
    pytest.importorskip("matplotlib")
    scene = stiffmbs.load_scene(EXAMPLES / "heavy_top.yaml")
    solution = stiffmbs.run(scene, duration=0.2)
    (axes,) = drawn(solution, scene.figure).axes
    (path,) = axes.lines
    for drawn_there, channel in zip(path.get_data_3d(), ("top.x", "top.y", "top.z"), strict=True):
        np.testing.assert_array_equal(drawn_there, solution[channel])
    file = str(tmp_path / "top.png")
    result = CliRunner().invoke(main, ["run", str(EXAMPLES / "heavy_top.yaml"), "--json", "--figure", file])
    assert result.exit_code == 0 and (tmp_path / "top.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("figure", "sentence"),
    [
        ("{x: top.x, y: [top.y, top.x], z: top.z}", "expected a channel x and one y"),
        ("{y: [top.y], z: top.z}", "found 'top.z' with x: time"),
        ("{x: top.x, y: [top.y], z: top.w}", "found no channel 'top.w'"),
    ],
)
def test_a_figure_that_is_no_path_is_refused(figure, sentence, tmp_path):
    pytest.importorskip("matplotlib")
    arguments = ["run", str(EXAMPLES / "heavy_top.yaml"), "--duration", "0.1", "--figure", str(tmp_path / "top.png")]
    result = CliRunner().invoke(main, [*arguments, "--set", f"figure={figure}"])
    assert result.exit_code == 2
    assert sentence in result.output and "Traceback" not in result.output
