"""Points on curves and curves that touch, written as datasets: read again they are the same scenes, and move alike."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.export.dataset_text import dataset_text
from stiffmbs.adams.load import read_adams

from . import test_adams_curves as beads
from . import test_adams_touching_curves as cams

X = beads.X
BENT = np.column_stack([X, 60 * np.sin(X / 150), beads.Z])
RING = beads.ring(1) + np.column_stack([np.zeros(25), 40 * np.sin(2 * np.linspace(0, 2 * np.pi, 25)), np.zeros(25)])
RING[-1] = RING[0]
DATASETS = {
    "flat wire": beads.dataset(np.column_stack([X, 0 * X, beads.Z]), first=[X[2], 0, beads.Z[2]]),
    "bent wire": beads.dataset(BENT, first=BENT[2]),
    "closed wire": beads.dataset(RING, "CLOSED", RING[5]),
    "cam": cams.dataset(cams.ellipse(40, 40), cams.FACE, (15, 0), 40, spin=8.0),
    "roller": cams.dataset(cams.ellipse(40, 40), cams.ellipse(10, 10), (15, 0), np.sqrt(50**2 - 15**2), "CLOSED", 8.0),
}


def _statements(text):
    return sum(line[0] not in ",!" for line in text.splitlines())


@pytest.mark.parametrize("name", DATASETS)
def test_curves_are_written_as_they_were_read(name):
    scene = read_adams(DATASETS[name])
    text = dataset_text(scene)
    again = read_adams(text)
    written = dataset_text(again)
    assert _statements(dataset_text(read_adams(written))) == _statements(written)
    assert max(map(len, text.splitlines())) <= 80
    curved = [joint for joint in scene.joints.values() if joint.kind in ("point_on_curve", "tangent_to_curve")]
    written = [joint for joint in again.joints.values() if joint.kind == curved[0].kind]
    for one, other in zip(curved, written, strict=True):
        for law in ("y", "z", "radius", "height"):
            if getattr(one, law, None) is not None:
                table, same = (np.array(getattr(joint, law).table) for joint in (one, other))
                np.testing.assert_allclose(
                    abs(same[:, 1]), abs(table[:, 1]), atol=1e-12
                )  # about either side of the way


@pytest.mark.sampled(6)
@pytest.mark.long
@pytest.mark.parametrize("name", DATASETS)
def test_they_move_alike(name):
    scene = read_adams(DATASETS[name])
    again = read_adams(dataset_text(scene))
    one, other = (stiffmbs.run(each, duration=0.3, points=7, rtol=1e-9) for each in (scene, again))
    moving = [body for body in scene.bodies if not body.endswith("_touch")]
    for body, read in zip(moving, again.bodies, strict=False):
        for axis in "xyz":
            np.testing.assert_allclose(other[f"{read}.{axis}"], one[f"{body}.{axis}"], atol=1e-7)


def test_a_curve_by_a_formula_is_refused():
    text = "dimensions: 3\nbodies: {b: {mass: 1, inertia: [1, 1, 1]}}\njoints: {c: {type: point_on_curve, i: b, j: ground, y: x^2}}\n"
    with pytest.raises(
        InputError, match=r"joints\.c: found a curve by another law, expected a table with 'ends: not-a-knot'"
    ):
        dataset_text(stiffmbs.read_scene(text))
