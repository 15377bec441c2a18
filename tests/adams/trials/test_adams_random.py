"""Random Adams datasets, as Adams/View writes them, against the same mechanisms by equations that share no code."""

import numpy as np
import pytest

from . import adams_random
from .adams_trials import moves_alike, near, played, table

TIMES = np.linspace(0, 0.5, 26)


@pytest.fixture(scope="module")
def play(tmp_path_factory):
    def both(seed):
        trial = adams_random.random_trial(seed)
        text = trial.text()
        solution = played(tmp_path_factory.mktemp(f"seed{seed}"), text, 0.5, head="", rtol=1e-9)
        return trial, solution, trial.mechanism().run(TIMES)

    return both


@pytest.mark.long
@pytest.mark.parametrize("seed", range(40))
@pytest.mark.sampled(33)
def test_motion_reactions_and_requests(play, seed):
    trial, solution, history = play(seed)
    for k in range(len(trial.bodies)):
        moves_alike(solution, f"PART_{k + 2}", history.part(k), 1e-6)
    for name, marker in trial.reactions.items():
        wanted = history.reaction(name, marker)
        near(table(solution, name), wanted, 5e-5, max(np.abs(wanted).max(), 1e-3))
    for number, (sort, *markers) in trial.asked.items():
        QUESTIONS.get(sort, asks_force)(solution, history, f"REQUEST_{number}", trial, sort, *markers)


def asks_displacement(solution, history, request, trial, sort, *idents):
    i, j, rm = (trial.markers[ident] for ident in idents)
    gap = history.ask(lambda view: view.axes(rm).T @ (view.point(i) - view.point(j)).value)
    near(table(solution, request, "x y z"), gap, 1e-6)
    angles = history.ask(lambda view: body313(view.axes(j).T @ view.axes(i)))
    defined = np.sin(angles[:, 1]) > 1e-3
    turned = (table(solution, request, "psi theta phi") - angles)[defined]
    assert np.all(np.abs(np.sin(turned / 2)) < 1e-5)  # whole turns do not count


def body313(turn):
    theta = np.arccos(np.clip(turn[2, 2], -1, 1))
    return np.arctan2(turn[0, 2], -turn[1, 2]), theta, np.arctan2(turn[2, 0], turn[2, 1])


def asks_velocity(solution, history, request, trial, sort, *idents):
    i, j, rm = (trial.markers[ident] for ident in idents)

    def rates(view):
        moving, spinning = view.point(i) - view.point(j), view.spin(i) - view.spin(j)
        return np.concatenate([view.axes(rm).T @ moving.rate, view.axes(rm).T @ spinning.rate])

    wanted = history.ask(rates)
    near(table(solution, request, "vx vy vz wx wy wz"), wanted, 2e-5, max(np.abs(wanted).max(), 1e-2))


def asks_acceleration(solution, history, request, trial, sort, *idents):
    i, j, rm = (trial.markers[ident] for ident in idents)
    rows = []
    for view, found, _ in history.instants:
        gains = [accelerated(view, found, marker) for marker in (i, j)]
        rows.append(np.concatenate([view.axes(rm).T @ (a - b) for a, b in zip(*gains, strict=True)]))
    wanted = np.array(rows)
    near(table(solution, request, "accx accy accz wdtx wdty wdtz"), wanted, 5e-5, max(np.abs(wanted).max(), 1e-2))


def accelerated(view, found, marker):
    """Acceleration of a marker and angular acceleration of its part, in ground axes."""
    if marker.part < 0:
        return np.zeros(3), np.zeros(3)
    k = marker.part
    arm, spin = view.point(marker).value - view.r[k], view.w[k]
    return found[0, k] + np.cross(found[1, k], arm) + np.cross(spin, np.cross(spin, arm)), found[1, k]


def asks_force(solution, history, request, trial, joint, i, j, rm, on_j):
    """REQUEST FORCE between the joint's markers in SI, and its functions in the dataset's units, on I or on J.

    The request sums the joint and its motion (Adams/Solver, FX and INFO/FORCE), the functions are those of the joint.
    """
    axes = history.ask(lambda view: view.axes(trial.markers[rm]))

    def seen(element, marker):
        wanted = history.reaction(element, trial.markers[marker])
        return np.hstack([np.einsum("tij,ti->tj", axes, wanted[:, k : k + 3]) for k in (0, 3)])

    motion = f"MOTION_{joint.rpartition('_')[2]}"
    wanted = seen(joint, i) + (seen(motion, i) if motion in trial.reactions else 0.0)
    near(table(solution, request), wanted, 5e-5, max(np.abs(wanted).max(), 1e-3))
    wanted = seen(joint, j if on_j else i)
    units = np.repeat([trial.force, trial.force * trial.length], 3)
    found = table(solution, "REQUEST_5", "f2 f3 f4 f6 f7 f8") * units
    near(found, wanted, 5e-5, max(np.abs(wanted).max(), 1e-3))


QUESTIONS = {"DISPLACEMENT": asks_displacement, "VELOCITY": asks_velocity, "ACCELERATION": asks_acceleration}
