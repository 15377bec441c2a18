"""Check of stiff forces in long steps of order 1."""

import tracemalloc
from types import SimpleNamespace

import numpy as np

import stiffmbs
from stiffmbs.run_checks.uncertain_forces import coarse_forces_notes
from stiffmbs.tuning import in_use


def test_many_rows_are_read_in_blocks():
    """Two copies of all velocities were made, which may be larger than the memory."""
    count, width = 20_000, 50
    t = np.linspace(0.0, 1.0, count)
    rows = SimpleNamespace(t=t, u=np.repeat(t[:, None], width, axis=1), acceleration=np.ones((count, width)))
    history = SimpleNamespace(t=np.array([0.001, 0.5, 1.0]), order=np.array([1, 2, 2]))
    trajectory = SimpleNamespace(t=t, history=history, step_times=history.t, statistics={"jacobians": 1})
    dynamics = SimpleNamespace(system=SimpleNamespace(mass=np.ones(width)))
    with in_use({"storage": {"block": 100}}):
        tracemalloc.start()
        assert not [*coarse_forces_notes(dynamics, trajectory, rows)]
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 0.5 * rows.u.nbytes


RING = """
gravity: [0, 0]
bodies:
  top: &arc
    type: beam
    start: [0.7, 0]
    through: [0, 0.7]
    end: [-0.7, 0]
    elements: 2
    section: {type: rectangle, width: 30 mm, height: 3 mm}
    material: {E: 2e9, nu: 0.3, density: 1200}
  bottom: {<<: *arc, start: [-0.7, 0], through: [0, -0.7], end: [0.7, 0]}
joints:
  left: {type: fixed, i: top.end, j: bottom.start}
  right: {type: fixed, i: bottom.end, j: top.start}
run: {duration: 0.1, points: 11, solver: bdf}
"""


def test_forces_of_rounding_in_a_ring_at_rest_are_no_coarse_forces():
    """All its forces are zero but for rounding; no smaller tolerance and no other solver changes them."""
    solution = stiffmbs.run(stiffmbs.read_scene(RING), errors=False)
    assert np.abs(solution["left.fx"]).max() < 1e-8
    assert not [note for note in solution.notes if getattr(note, "kind", "") == "coarse-forces"]
