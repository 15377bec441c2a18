"""A study that was killed goes on where it was, and ends with the same table."""

import os
import random
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, sweep

PROGRAM = """
import sys, numpy, stiffmbs
stiffmbs.sweep(sys.argv[1], k_b=numpy.logspace(5, 7, int(sys.argv[3])), outputs=["peak(front_bushing.fx)", "chassis.y"], rtol=1e-6,
               store=sys.argv[2], workers=2, watch=lambda *now: print(*now, flush=True))
"""


def killed_again_and_again(scene, store, cases, kills, chance):
    """Start a study so many times, each time killed after some cases; its last session is left alone."""
    for _ in range(kills):
        session = subprocess.Popen([sys.executable, "-c", PROGRAM, scene, store, str(cases)], stdout=subprocess.PIPE)
        assert session.stdout.readline(), "the study ended before it was killed"
        time.sleep(chance.uniform(0, 0.05))
        os.kill(session.pid, signal.SIGKILL)
        session.wait()
    return sweep(
        scene, k_b=np.logspace(5, 7, cases), outputs=["peak(front_bushing.fx)", "chassis.y"], rtol=1e-6, store=store
    )


@pytest.mark.long(40)
@pytest.mark.sampled(2)
@pytest.mark.parametrize(("kills", "cases"), [(3, 24), (20, 400)])
def test_a_killed_study_ends_with_the_same_table_to_the_last_bit(examples, tmp_path, kills, cases):
    scene = str(examples / "half_car.yaml")
    found = killed_again_and_again(scene, str(tmp_path / "rows"), cases, kills, random.Random(kills))
    expected = sweep(scene, k_b=np.logspace(5, 7, cases), outputs=["peak(front_bushing.fx)", "chassis.y"], rtol=1e-6)
    assert found.identical(expected)


def test_only_what_is_missing_is_solved(examples, tmp_path):
    scene, store, seen = examples / "cart_pendulum.yaml", tmp_path / "rows", []

    def stopped(done, *_):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(scene, L=[0.5, 0.6, 0.7], duration=0.1, store=store, watch=stopped)
    sweep(scene, L=[0.5, 0.6, 0.7], duration=0.1, store=store, watch=lambda done, *_: seen.append(done))
    assert seen == [3]


def test_rows_of_another_study_are_refused(examples, tmp_path):
    scene, store = examples / "cart_pendulum.yaml", tmp_path / "rows"
    sweep(scene, L=[0.5], duration=0.1, store=store)
    for other in ({"L": [0.6]}, {"L": [0.5], "rtol": 1e-5}, {"L": [0.5], "outputs": "final(cart.x)"}):
        with pytest.raises(InputError, match="found the rows of another study"):
            sweep(scene, duration=0.1, store=store, **other)
    changed = stiffmbs.load_scene(scene, [("bodies.bar.mass", "2")])
    with pytest.raises(InputError, match="found the rows of another study"):
        sweep(changed, L=[0.5], duration=0.1, store=store)
    (tmp_path / "text").write_text("no table at all, but a text that is long enough to be read as one")
    with pytest.raises(InputError, match="expected the store of a study"):
        sweep(scene, L=[0.5], duration=0.1, store=tmp_path / "text")
