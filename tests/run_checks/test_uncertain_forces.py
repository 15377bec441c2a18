"""Check of stiff forces in long steps of order 1."""

import tracemalloc
from types import SimpleNamespace

import numpy as np

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
