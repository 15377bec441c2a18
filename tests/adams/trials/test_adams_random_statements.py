"""Random datasets with FRICTION, JOINT() in forces, PTCV, PINPUT and SENSOR against equations that share no code."""

import numpy as np
import pytest

from .adams_random_statements import random_statements
from .adams_trials import moves_alike, near, played, table

TIMES = np.linspace(0, 0.3, 16)


def both(folder, seed):
    trial = random_statements(seed)
    found = played(folder, trial.text(), 0.3, head="", rtol=1e-9)
    return trial, found, trial.mechanism().run(TIMES, rtol=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.sampled(13)
def test_motion_and_reactions(tmp_path, seed):
    trial, found, history = both(tmp_path, seed)
    for k in range(len(trial.bodies)):
        moves_alike(found, f"PART_{k + 2}", history.part(k), 2e-6)
    for name, marker in trial.reactions.items():
        wanted = history.reaction(name, marker)
        near(table(found, name), wanted, 2e-4, max(np.abs(wanted).max(), 1e-3))


@pytest.mark.sampled(4)
@pytest.mark.long
@pytest.mark.parametrize("seed", range(100, 104))
def test_a_sensor_ends_the_run_where_its_function_passes_the_value(tmp_path, seed):
    """The first instant in ground's x of the first part's centre is known from the equations."""
    trial = random_statements(seed)
    history = trial.mechanism().run(TIMES, rtol=1e-9)
    x = history.part(0)["x"]
    last = int(np.argmax(np.append(np.diff(x) * np.sign(x[1] - x[0]) < 0, True)))
    if last < 4 or np.abs(np.diff(x[: last + 1])).min() < 1e-5:
        pytest.skip("the part turns back at once")
    value = x[last - 1] / trial.length
    center = 11 + 1  # the marker after that of ground
    trial.statement("SENSOR/1", f"FUNCTION = DX({center})", f"VALUE = {value:.16g}", f"ERROR = {1e-9 / trial.length:.16g}",
                    "GE" if x[1] > x[0] else "LE", "HALT")  # fmt: skip
    found = played(tmp_path, trial.text(), 0.3, head="", rtol=1e-9)
    assert found.time[-1] == pytest.approx(TIMES[last - 1], abs=2e-4)
    assert found["PART_2.x"][-1] == pytest.approx(x[last - 1], abs=1e-6)
