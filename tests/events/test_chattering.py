"""Motions that come to no end are told in the same words by every solver, and those that only change their law often are not."""

from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AlgebraicState, AppliedForce, Body, Model, Prismatic, Revolute
from stiffmbs.analyses.run import prepare
from stiffmbs.dynamics.dynamics import Dynamics
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.solve.events import chattering
from stiffmbs.solve.events.chattering import CHATTERING, Chattering
from stiffmbs.solve.events.discontinuity import sliding
from stiffmbs.solve.explicit import fixed
from stiffmbs.solve.ida.ida import NativeIda
from stiffmbs.solve.trajectory import Outcome
from stiffmbs.tuning import parameters_of
from tests.stress.families.roads.kinks import SLIDES, belts, follower
from tests.stress.families.roads.kinks import wheel as wheel_on_road

SOLVERS = ["bdf", "auto", "dop853", "dopri5"]


def solve(model, solver, **how):
    chosen = {"solver": "projected", "scheme": solver} if solver.startswith("dop") else {"solver": solver}
    return stiffmbs.run(model, **chosen, **{"duration": 2.0, "points": 101, **how})


def block(law, **body):
    model = Model()
    model.add("block", Body(mass=1, inertia=1, **body))
    model.add("rail", Prismatic(i="block", j="ground"))
    model.add("push", AppliedForce(i="block", force=(law, 0)))
    return model


def wheel(law):
    model = Model()
    model.add("wheel", Body(mass=1, inertia=0.1))
    model.add("pin", Revolute(i="wheel", j="ground"))
    model.add("push", FORCES["torque"](i="wheel", torque=law))
    return model


def rubbing_blocks():
    """One block is slowed by the other, which a spring holds: they stick at 0.54 s."""
    model = Model()
    for name, velocity in (("a", (1, 0)), ("b", (0, 0))):
        model.add(name, Body(mass=1, inertia=1, velocity=velocity))
        model.add(f"rail_{name}", Prismatic(i=name, j="ground"))
    model.add("push", AppliedForce(i="a", force=("-sign(a.vx - b.vx)", 0)))
    model.add("pull", AppliedForce(i="b", force=("sign(a.vx - b.vx) - 3*b.x", 0)))
    return model


def held_pendulum():
    model = Model(gravity=(0, -9.81))
    bob = model.add("bob", Body(mass=1, inertia=0.1, position=(1, 0)))
    model.add("pin", Revolute(i=bob.at(-1, 0), j="ground"))
    model.add("push", FORCES["torque"](i="bob", torque="-4*sign(bob.omega)"))
    return model


def relay():
    """A speed kept by a relay that follows an algebraic state, against a spring and a damper."""
    model = Model()
    model.add("block", Body(mass=1, inertia=1))
    model.add("rail", Prismatic(i="block", j="ground"))
    model.add("p", AlgebraicState(zero="p - block.x - 0.975*block.vx"))
    law = "branch(p - 0.03, 12.25, 0, 2.17) - 5.44 - 10*block.x - 0.9*block.vx"
    model.add("push", AppliedForce(i="block", force=(law, 0)))
    return model


STUCK = {
    "friction on a block": (lambda: block("-5*sign(block.vx)", velocity=(1, 0)), 0.2),
    "friction on a block pulled at rest": (lambda: block("3 - 5*sign(block.vx)"), 0.0),
    "a block on a belt": (lambda: block("-5*sign(block.vx - 1) - 20*block.x"), 0.2476),
    "a speed kept by a relay": (lambda: wheel("branch(wheel.omega - 5, 3, 0, -3)"), 1 / 6),
    "two blocks that rub": (rubbing_blocks, 0.537),
    "a pendulum held by friction": (held_pendulum, 2.325),
    "a switching line": (lambda: block("branch(block.x + block.vx, 9, 0, -9)", position=(1, 0)), np.sqrt(11) / 3 - 1),
    "a relay that follows an algebraic state": (relay, 0.0045),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("scene", STUCK)
def test_a_force_that_jumps_where_the_motion_stays_is_told_soon(scene, solver):
    make, instant = STUCK[scene]
    solution = solve(make(), solver, duration=4.0, points=401)
    assert solution.outcome is Outcome.STOPPED
    assert "'push' chatters" in solution.message
    stopped = float(solution.message.split("t = ")[1].split(" s")[0])
    assert instant - 1e-3 < stopped < instant + 0.15
    assert solution.solver["steps"] < 30_000


@pytest.mark.parametrize("scheme", ["rk4", "euler_cromer"])
@pytest.mark.parametrize("scene", ["friction on a block", "two blocks that rub", "a block on a belt"])
def test_fixed_steps_note_a_force_that_jumps_back_and_forth(scene, scheme):
    make, instant = STUCK[scene]
    solution = stiffmbs.run(make(), solver="projected", scheme=scheme, duration=2.0, points=401)
    assert solution.outcome is Outcome.DONE
    (note,) = [note for note in solution.notes if "'push' chatters" in note]
    assert instant <= float(note.split("t = ")[1].split(" s")[0]) < instant + 0.2


def test_looks_at_a_jump_leave_fixed_steps_as_they_are(monkeypatch):
    found = []
    for looks in (50, 1):
        monkeypatch.setattr(fixed, "FIXED_STEP", replace(parameters_of(fixed.FIXED_STEP), checks=looks))
        found.append(
            stiffmbs.run(
                block("-5*sign(block.vx)", velocity=(1, 0)),
                solver="projected",
                scheme="euler_cromer",
                duration=1.0,
                points=101,
            )
        )
    np.testing.assert_array_equal(found[0]["block.x"], found[1]["block.x"])


def spun_up():
    """A torque that follows a marker's velocity spins the body ever faster: its law changes twice in each turn."""
    model = Model(gravity=(0, -9.81))
    marker = {"m": {"point": (0.28, -0.22)}}
    model.add("b", Body(mass=1, inertia=0.04, angle=-2.87, velocity=(-0.9, -0.4), omega=-1.6, markers=marker))
    law = "branch(-vy(b.m) - 0.1, 5.66*vy(b.m), 0, -0.566 - 3*(vy(b.m) + 0.1))"
    model.add("push", FORCES["torque"](i="b", torque=law))
    return model


@pytest.mark.long
def test_events_within_steps_count_too(monkeypatch):
    """IDA knows no event function of events that the search within its steps has found: a run of them did not end."""
    monkeypatch.setattr(NativeIda, "roots", lambda ida: np.zeros(ida.watch.n_event_functions, dtype=int))
    found = solve(spun_up(), "bdf", duration=40.0)
    assert found.outcome is Outcome.STOPPED and "chatters: it has passed breakpoints" in found.message


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_law_that_changes_ever_faster_is_told_within_some_thousand_changes(solver):
    solution = solve(spun_up(), solver, duration=1.0)
    assert solution.outcome is Outcome.STOPPED
    assert "'push' chatters" in solution.message
    assert 2 * CHATTERING.window <= solution.solver["events"] <= 5 * CHATTERING.window


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "dop853", "bdf"])
def test_a_relay_that_swings_on_and_on_is_followed(solver):
    """x'' = -5 sign(x) from x = 0 at 0.01 m/s swings with 250 Hz; each change of law is one of the motion."""
    solution = solve(block("-5*sign(block.x)", velocity=(0.01, 0)), solver, rtol=1e-8)
    assert solution.outcome is Outcome.DONE
    assert abs(solution.solver["events"] - 500) < 15
    assert np.max(np.abs(solution["block.x"])) < 1.2e-5


def test_the_number_of_events_to_come_follows_the_law_of_their_growth():
    """Events of a motion that is driven evenly faster are many, but not beyond all bounds; exponential growth is."""
    dynamics = Dynamics(stiffmbs.compile.compile_model.compile_model(block("-5*sign(block.x)").data()))
    state = np.ones(3), np.ones(3)  # far from the jump
    evenly = Chattering(dynamics, 10.0, 1e-6)
    for k in range(1, 30_000):
        evenly.note_event(10.0 * np.sqrt(k / 60_000), lambda: state, 0)
    exponentially = Chattering(dynamics, 2.0, 1e-6)
    with pytest.raises(stiffmbs.errors.SolverError, match="'push' chatters"):
        for k in range(1, 10_000):
            exponentially.note_event(np.log(k) / 10.0, lambda: state, 0)


@pytest.mark.parametrize("solver", ["bdf", "dop853"])
def test_steps_too_short_to_arrive_end_the_run(solver, monkeypatch):
    changed = replace(parameters_of(chattering.CHATTERING), steps_seen=5000, steps_ahead=20_000)
    monkeypatch.setattr(chattering, "CHATTERING", changed)
    rub = "-1000*block.vx/sqrt(block.vx^2 + block.vy^2)"
    solution = solve(block(rub, velocity=(1, 0)), solver, duration=10.0)
    assert solution.outcome is Outcome.STOPPED
    assert solution.solver["steps"] < 100_000


def looked_at(law, speed):
    """What slides in a block of such a speed at x = 0, and how often terms are evaluated to tell."""
    job = prepare(block(law, velocity=(speed, 0)), presolve=False)
    before = job.dynamics.state.evaluations
    found = sliding(job.dynamics, 0.0, job.start.q, job.start.u)
    return len(found), job.dynamics.state.evaluations - before


def test_a_jump_at_a_place_is_passed_whatever_the_accelerations():
    assert looked_at("-20*sign(block.x)", 1.0) == (0, 4)


def test_a_jump_that_drives_the_motion_back_is_found():
    assert looked_at("-2*sign(block.vx)", 1e-9)[0] == 1


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "profile", "damping"),
    [(wheel_on_road, "crest", 50.0), (follower, "crest", 0.0), (follower, "pothole", 50.0), (follower, "bump", 500.0)],
)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_damper_over_a_kink_is_passed(solver, scene, profile, damping):
    """The force of a spring and damper jumps through zero where its support bends: an event function that jumps does not slide."""
    solution = solve(scene(profile, 20.0, damping), solver, duration=1.5, rtol=1e-5)
    assert solution.outcome is Outcome.DONE, solution.message


@pytest.mark.parametrize("solver", SOLVERS)
def test_friction_slides_on_the_belt_whose_speed_is_reached_not_where_belts_meet(solver):
    solution = solve(belts(), solver, duration=8.0, points=401)
    assert "'f' chatters" in solution.message
    assert abs(solution.t[-1] - SLIDES) < 0.05


def test_a_jump_that_a_stiff_spring_nearly_balances_is_told():
    """Where a spring changes the force by more than the jump leaves, within the distance of the check."""
    model = Model()
    model.add("block", Body(mass=1, inertia=1))
    model.add("rail", Prismatic(i="block", j="ground"))
    law = "branch(block.vx + 0.2, 1.5821*block.vx, 1.5821*block.vx, 1.68358 + 5.6743*(block.vx + 0.2))"
    model.add("push", AppliedForce(i="block", force=(f"3.99*sin(5.3705*t) - 67.688*block.x - ({law})", 0)))
    solution = solve(model, "dop853", rtol=1e-5)
    assert not solution.success
    assert "'push' chatters" in solution.message
