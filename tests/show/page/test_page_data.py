"""What pages hold: numbers that come back to their digits, small enough, and harmless."""

import base64
import gzip
import json
import re

import numpy as np
import pytest

import stiffmbs
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.poses import poses_of
from stiffmbs.show.page.data import LEVELS, Packed, page_data
from stiffmbs.show.page.modes import modes_data

from ...conftest import EXAMPLES


def column(numbers, at):
    levels = np.cumsum(numbers[at["start"] : at["start"] + at["length"]].astype(np.int64)) % (LEVELS + 1)
    return np.where(levels == LEVELS, np.nan, at["low"] + at["step"] * levels)


def unpacked(data):
    head, numbers = (gzip.decompress(base64.b64decode(data[name])) for name in ("head", "numbers"))
    return json.loads(head), np.frombuffer(numbers, dtype="<u2")


@pytest.mark.parametrize(
    "values",
    [
        np.sin(np.linspace(0, 9, 400)) * 1e6,
        np.full(5, 3.25),
        np.array([1.0, np.nan, -1e-9]),
        np.array([np.nan, np.nan]),
    ],
    ids=["wave", "constant", "gap", "nothing"],
)
def test_packed_numbers_come_back(values):
    packed = Packed()
    packed.add(np.arange(3.0))
    at = packed.add(values)
    found = column(np.frombuffer(gzip.decompress(base64.b64decode(packed.text())), dtype="<u2"), at)
    known = np.isfinite(values)
    assert (np.isnan(found) == ~known).all()
    if known.any():
        assert np.abs(found - values)[known].max() <= 1e-5 * np.ptp(values[known])


def test_poses_of_a_page_are_those_of_the_run():
    scene = stiffmbs.load_scene(EXAMPLES / "heavy_top.yaml")
    solution = stiffmbs.run(scene, duration=2.0)
    for k in range(4):
        solution[f"top.q{k}"][100:] *= -1  # the same orientations
    head, numbers = unpacked(
        page_data(drawing_of(scene), {"": poses_of(scene, solution.time, solution.channels)}, solution)
    )
    (run,) = head["runs"]
    time = np.linspace(run["start"], run["end"], run["count"])
    pose = np.column_stack([column(numbers, at) for at in run["bodies"]["top"]])
    for k, name in enumerate(("x", "y", "z")):
        assert pose[:, k] == pytest.approx(np.interp(time, solution.time, solution[f"top.{name}"]), abs=2e-4)
    assert (np.sum(pose[1:, 3:] * pose[:-1, 3:], axis=1) > 0.9).all()  # between them lies the shorter way
    signs = np.sign(pose[0, 3] * solution["top.q0"][0])
    nearest = [np.argmin(np.abs(solution.time - t)) for t in time[::50]]
    for q, k in zip(pose[::50, 3:], nearest, strict=True):
        assert abs(signs * q @ [solution[f"top.q{n}"][k] for n in range(4)]) == pytest.approx(1, abs=1e-2)
    force = next(c for c in head["channels"]["columns"] if c["name"] == "tip.fz")
    assert column(numbers, force).max() == pytest.approx(solution["tip.fz"].max(), rel=1e-3)
    assert force["unit"] == "N"


@pytest.mark.long
def test_a_page_of_a_large_model_stays_small():
    """Three times the channels of a car for ten seconds."""
    scene = stiffmbs.load_scene(EXAMPLES / "chain.yaml", [("N", "80")])
    solution = stiffmbs.run(scene, duration=0.5, points=501)
    data = page_data(drawing_of(scene), {"": poses_of(scene, solution.time, solution.channels)}, solution)
    assert sum(map(len, data.values())) < 2_000_000


def test_texts_of_a_page_are_no_markup():
    scene = stiffmbs.read_scene(
        "name: '</script><img src=x onerror=alert(1)>'\nbodies: {a: {mass: 1, inertia: 1}}\nrun: {duration: 1, points: 5}"
    )
    solution = stiffmbs.run(scene)
    data = page_data(drawing_of(scene), {"<b>": poses_of(scene, solution.time, solution.channels)}, solution)
    assert all(re.fullmatch(r"[A-Za-z0-9+/=]*", text) for text in data.values())


def test_the_page_of_modes_shows_one_period_of_each_vibration():
    found = stiffmbs.modes(EXAMPLES / "half_car.yaml")
    head, _ = unpacked(modes_data(found, 0.02))
    assert head["choose"] == "Mode"
    vibrations = [mode for mode in found.modes if mode.motion.value == "oscillating"]
    assert len(head["runs"]) == len(vibrations) == 8
    for run, mode in zip(head["runs"], vibrations, strict=True):
        assert run["end"] - run["start"] == pytest.approx(2 * np.pi / abs(mode.eigenvalues[0].imag), rel=1e-6)
        assert f": {mode.natural_frequency:.4g} Hz" in run["name"]
