"""Sampled states against exact discrete solutions, in runs, restarts, simulations and analyses of one instant."""

import tracemalloc

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import stiffmbs

M, K, C = 2.0, 50.0, 0.4
KP, KI, GOAL = 30.0, 120.0, 0.1
SCENE = """
bodies: {block: {mass: 2, inertia: 0.1, position: [0.2, 0], velocity: [0.3, 0]}}
joints: {rail: {type: prismatic, i: block, j: ground}}
parameters: {goal: 0.1, kp: 30, ki: 120, Ts: 0.037, Tf: 0.037, late: 0}
states:
  integral: {update: integral + ki*Ts*(goal - block.x), period: Ts}
  push: {update: kp*(goal - block.x) - 2*block.vx + integral, period: Tf, offset: late}
forces: {spring: {type: force, i: block, force: [-50*block.x - 0.4*block.vx + push, 0]}}
"""
SOLVERS = [
    ({"solver": "bdf", "rtol": 1e-9}, 1e-6),
    ({"solver": "radau", "rtol": 1e-9}, 1e-8),
    ({"solver": "projected", "scheme": "dop853", "rtol": 1e-9}, 1e-9),
    ({"solver": "projected", "scheme": "rk4", "step": 1e-3}, 1e-8),
    ({"solver": "auto", "rtol": 1e-9}, 1e-9),
]


def exact(times, slow=0.037, fast=0.037, late=0.0):
    """Return x, v, push and integral by matrix exponentials from sample to sample; at a sample those before it."""
    block = np.zeros((3, 3))
    block[:2] = [[0, 1, 0], [-K / M, -C / M, 1 / M]]
    x, push, integral, now, found = np.array([0.2, 0.3]), 0.0, 0.0, 0.0, []
    counts = {"slow": 0, "fast": 0}
    for end in times:
        while True:
            at = {"slow": counts["slow"] * slow, "fast": late + counts["fast"] * fast}
            t = min(at.values())
            if t >= end - 1e-9:
                break
            x, now = (expm(block * (t - now)) @ [*x, push])[:2], t
            before = integral
            if at["slow"] < t + 1e-9:
                integral, counts["slow"] = before + KI * slow * (GOAL - x[0]), counts["slow"] + 1
            if at["fast"] < t + 1e-9:
                push, counts["fast"] = KP * (GOAL - x[0]) - 2 * x[1] + before, counts["fast"] + 1
        found.append([*(expm(block * (end - now)) @ [*x, push])[:2], push, integral])
    return np.array(found).T


def differences(found, *rates):
    names = ("block.x", "block.vx", "push", "integral")
    return [np.abs(found[name] - known).max() for name, known in zip(names, exact(found.time, *rates), strict=True)]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("settings", "error"), SOLVERS, ids=lambda x: x.get("scheme", x["solver"]) if isinstance(x, dict) else ""
)
def test_a_sampled_controller_follows_the_exact_discrete_solution(settings, error):
    """Output every 20 ms falls between samples, and on one at 0.74 s and 1.48 s, where it is the state before it."""
    assert max(differences(stiffmbs.run(stiffmbs.read_scene(SCENE), duration=2, output=0.02, **settings))) < error


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6])
def test_error_bars_are_those_of_the_exact_solution(solver, rtol):
    """Explicit steps end at samples with any tolerance; bars by a run with the same steps were zero."""
    found = stiffmbs.run(stiffmbs.read_scene(SCENE), duration=2, solver=solver, rtol=rtol, errors=True)
    names = ("block.x", "block.vx", "push", "integral")
    for name, true in zip(names, differences(found), strict=True):
        assert 0.4 * true < found.errors[name].over_time < 2.5 * true + 1e-12, name


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_force_that_samples_change_has_no_peak_between_equal_values(solver):
    """Its greatest value between outputs is that of a sample: parabolas across the jumps were up to three times as high."""
    scene = stiffmbs.read_scene(SCENE, [("Ts", "0.02"), ("Tf", "0.02")])
    found = stiffmbs.run(scene, duration=1, output=0.05, rtol=1e-7, solver=solver, errors=True)
    true = exact(np.arange(1, 51) * 0.02 + 1e-6, 0.02, 0.02)[2]
    bar, shown = found.errors["push"], found["push"]
    for beyond, told in ((true.max() - shown.max(), bar.greatest), (shown.min() - true.min(), bar.least)):
        assert 0.9 * beyond <= told <= 1.2 * max(beyond, 0.0) + 1e-4


def test_states_of_two_rates_are_sampled_at_their_own_times():
    changes = [("Ts", "0.05"), ("Tf", "0.02"), ("late", "0.005")]
    scene = stiffmbs.read_scene(SCENE, changes)
    found = stiffmbs.run(scene, duration=1, output=0.01, rtol=1e-10, solver="projected", scheme="dop853")
    assert max(differences(found, 0.05, 0.02, 0.005)) < 1e-9
    steps = stiffmbs.run(scene, duration=1, points="steps", rtol=1e-10, solver="radau")
    assert max(differences(steps, 0.05, 0.02, 0.005)) < 1e-7
    assert np.all(np.diff(steps.time) > 0)


@pytest.mark.parametrize("solver", ["radau", "auto"])
def test_runs_and_simulations_in_pieces_take_each_sample_once(solver):
    """From a state saved at a sample, and by steps that end at samples up to rounding (ten times 0.1 is not 1)."""
    scene, settings = stiffmbs.read_scene(SCENE, [("Ts", "0.1"), ("Tf", "0.1")]), {"rtol": 1e-9, "solver": solver}
    first = stiffmbs.run(scene, duration=0.7, output=0.1, **settings)
    rest = stiffmbs.run(scene, start_from=first, duration=0.5, output=0.1, **settings)
    assert max(differences(rest, 0.1, 0.1)) < 1e-8
    simulation = stiffmbs.simulation(scene, **settings)
    for _ in range(30):
        simulation.step(0.1)
        x, _, push, _ = exact([simulation.t], 0.1, 0.1)[:, 0]
        assert [simulation["block.x"], simulation["push"]] == pytest.approx([x, push], abs=1e-8)


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("settings", [{"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}])
def test_a_run_with_all_steps_keeps_no_more_memory_for_each_sample_than_its_rows(settings):
    scene = stiffmbs.read_scene(SCENE.replace("0.037", "1e-3"))
    stiffmbs.run(scene, duration=0.01, points="steps", **settings)
    tracemalloc.start()
    try:
        found = stiffmbs.run(scene, duration=1.0, points="steps", **settings)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert len(found.time) > 1000 and peak < 55e6


def test_a_sampled_velocity_command_turns_a_drive_in_steps():
    """The velocity is t_k in each interval, so that the angle is a sum; kinematics and dynamics agree."""
    scene = """
bodies: {arm: {mass: 1, inertia: 0.2}}
joints: {hinge: {type: revolute, i: arm, j: ground}, motor: {type: drive, joint: hinge, velocity: speed}}
states: {speed: {update: t, period: 0.1 s}}
"""
    found = stiffmbs.run(stiffmbs.read_scene(scene), duration=1, output=0.05, rtol=1e-9)
    k = np.floor(found.time / 0.1 - 1e-9)
    expected = 0.1 * (0.1 * k * (k - 1) / 2) + 0.1 * k * (found.time - 0.1 * k)
    assert found["arm.angle"] == pytest.approx(np.where(k < 0, 0, expected), abs=1e-8)


def test_a_sample_reads_reactions_and_comparisons_of_an_update_are_no_events():
    """The hook carries 9.81 N of each kg; the drive alone moves nothing else."""
    scene = """
gravity: [0, -9.81]
bodies: {load: {mass: 3, inertia: 0.1}}
joints: {held: {type: fixed, i: load, j: ground}, }
states:
  weighed: {update: fy(held), period: 0.1 s, start: 0 N}
  side: {update: "sign(t - 0.25 s) + 0*tanh(load.y)", period: 0.1 s}
"""
    found = stiffmbs.run(stiffmbs.read_scene(scene), duration=0.5, output=0.05)
    assert found["weighed"][1:] == pytest.approx(np.full(10, 3 * 9.81))
    assert found["side"].tolist() == [0] + 6 * [-1] + 4 * [1]


def test_analyses_of_one_instant_keep_sampled_values():
    """Without the sampled force the oscillator has its own mode; the equilibrium is that of the held force."""
    scene = stiffmbs.read_scene(SCENE.replace("offset: late", "offset: late, start: 5"))
    modes = stiffmbs.modes(scene)
    (mode,) = modes.modes
    assert mode.frequency == pytest.approx(np.sqrt(K / M - (C / M / 2) ** 2) / (2 * np.pi), rel=1e-9)
    still = stiffmbs.equilibrium(scene)
    assert still.channels["block.x"] == pytest.approx(5 / K, rel=1e-9)
    for found in (modes, still):
        assert "sampled states keep their values: integral, push" in found.notes


WRONG = [
    ("update: t, period: 0", "period: found 0"),
    ("update: t", r"states\.push\.period: found nothing"),
    ("update: t, period: 10 ms, rate: 1", "found the unknown key"),
    (
        "update: 3 m/s, period: 10 ms, start: 0 N",
        "update: found '3 m/s', which is in m/s, expected N, the unit of start",
    ),
    ("update: blok.x, period: 10 ms", "found the unknown body 'blok'"),
]


@pytest.mark.parametrize(("entry", "message"), WRONG)
def test_wrong_entries_are_refused(entry, message):
    text = SCENE.replace("update: kp*(goal - block.x) - 2*block.vx + integral, period: Tf, offset: late", entry)
    with pytest.raises(stiffmbs.InputError, match=message):
        stiffmbs.read_scene(text.replace(", Tf: 0.037, late: 0", ""))


def test_positions_do_not_jump_with_samples_and_sensitivities_do_not_include_them():
    drive = SCENE.replace("j: ground}}", "j: ground}, motor: {type: drive, joint: rail, position: push}}")
    with pytest.raises(
        stiffmbs.InputError, match=r"'motor': found the sampled state 'push' in a constraint of positions"
    ):
        stiffmbs.run(stiffmbs.read_scene(drive))
    with pytest.raises(stiffmbs.InputError, match=r"states\.integral: found a sampled state"):
        stiffmbs.sensitivities(stiffmbs.read_scene(SCENE), "kp", "block.x")


def test_a_sample_without_a_value_stops_the_run_and_names_the_state():
    scene = stiffmbs.read_scene(SCENE.replace("integral + ki*Ts*(goal - block.x)", "sqrt(block.x)"))
    found = stiffmbs.run(scene, duration=3, output=0.01, rtol=1e-8)
    assert not found.success and found["block.x"][-1] < 0
    assert "the formula of the sampled state 'integral' has no finite value" in found.message


@pytest.mark.long
def test_intervals_are_integrated_at_once_while_no_value_changes_that_acts():
    """The controller acts after 1 s only; the count of samples, which nothing reads, is right at each output."""
    text = SCENE.replace("kp*(goal - block.x) - 2*block.vx + integral", "'branch(t - 1, 0, 0, 40*(goal - block.x))'")
    text = text.replace("integral + ki*Ts*(goal - block.x)", "integral + 1")
    scene = stiffmbs.read_scene(text, [("Ts", "0.001"), ("Tf", "0.005")])
    settings = {"output": 0.0025, "rtol": 1e-9, "solver": "projected", "scheme": "dop853"}
    rest, whole = stiffmbs.run(scene, duration=1, **settings), stiffmbs.run(scene, duration=1.5, **settings)
    assert rest.solver["steps"] < 150 < 200 < whole.solver["steps"], "steps of samples that act are 5 ms at most"
    for found in (rest, whole):
        assert found["integral"] == pytest.approx(np.ceil(found.time / 0.001 - 1e-6))
    free = np.array([[0, 1], [-K / M, -C / M]])
    assert rest["block.x"][-1] == pytest.approx((expm(free) @ [0.2, 0.3])[0], abs=1e-8)


ON_A_KINK = """
gravity: [0, 0]
bodies:
  table: {mass: 3, inertia: 1}
  block: {mass: 2, inertia: 1, position: [0.1, 0.5]}
joints:
  rail: {type: prismatic, i: table, j: ground}
  guide: {type: prismatic, i: block, j: {body: ground, point: [0, 0.5]}}
  drive: {type: drive, joint: rail, position: "0.05*sin(7*t) + 0.02*max(t - 0.5, 0)"}
states: {push: {update: -30*block.x - block.vx, period: 0.1}}
forces: {spring: {type: force, i: block, force: [-50*(block.x - table.x) + push, 0]}}
run: {duration: 1}
"""


def block_on_a_driven_table():
    """Return the position of the block at 1 s, by SciPy from sample to sample."""
    state = np.array([0.1, 0.0])
    for k in range(10):
        push = -30 * state[0] - state[1]

        def rate(t, y, push=push):
            table = 0.05 * np.sin(7 * t) + 0.02 * max(t - 0.5, 0)
            return [y[1], (-50 * (y[0] - table) + push) / 2]

        state = solve_ivp(rate, (0.1 * k, 0.1 * k + 0.1), state, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    return state[0]


@pytest.mark.parametrize("points", [11, 14], ids=["output at the sample", "no output there"])
@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
def test_a_sample_at_a_kink_of_a_drive(solver, points, tmp_path):
    """The restart after the sample began just before the kink, within rounding, and bdf and radau stopped there."""
    (path := tmp_path / "scene.yaml").write_text(ON_A_KINK, encoding="utf-8")
    found = stiffmbs.run(stiffmbs.load_scene(path), solver=solver, rtol=1e-6, points=points)
    assert found.success, found.message
    assert found["block.x"][-1] == pytest.approx(block_on_a_driven_table(), abs=1e-5)
    assert any("t = 0.5 s" in note and "velocities jump (table.vx by 0.02" in note for note in found.notes)
