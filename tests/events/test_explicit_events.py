"""Where a force changes its law, explicit steps end and start anew."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Contact, Model, Prismatic, SpringDamper
from stiffmbs.solve.trajectory import Outcome

G = 9.81
ADAPTIVE = ["dopri5", "dop853"]


def explicit(model, scheme="dop853", **changes):
    return stiffmbs.run(model, solver="projected", scheme=scheme, **changes)


def dropped_ball(**fields):
    model = Model(gravity=(0, -G))
    model.add("ball", Body(mass=0.5, inertia=1e-3, position=(0, 1.04)))
    model.add("contact", Contact(i="ball", j="ground", radius=0.04, **fields))
    return model


@pytest.mark.parametrize("scheme", ADAPTIVE)
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_a_step_ends_where_the_ball_meets_the_floor(scheme, rtol):
    """A fall of 1 m takes sqrt(2/g); the step ends there to 1e-10 s however loose the tolerance."""
    solution = explicit(dropped_ball(stiffness=1e6), scheme, duration=0.6, rtol=rtol)
    assert np.min(np.abs(solution.step_times - np.sqrt(2 / G))) < 1e-10
    assert solution.solver["events"] == 2


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_an_elastic_ball_returns_to_its_height(scheme):
    solution = explicit(dropped_ball(stiffness=1e6), scheme, duration=1.2, rtol=1e-9, points=4001)
    assert solution.energy_drift() < 1e-6
    after = solution["ball.y"][solution.time > 0.6]
    assert after.max() == pytest.approx(1.04, abs=1e-6)


def two_springs(k):
    """A sled on a rail whose spring is four times as stiff to the left."""
    model = Model()
    model.add("sled", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("rail", Prismatic(i="sled", j="ground"))
    model.add("spring", AppliedForce(i="sled", force=(f"-{k}*sled.x + {3 * k}*max(0, -sled.x)", 0)))
    return model


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_a_spring_with_a_corner_follows_its_closed_form(scheme):
    """Half periods of pi/w and pi/2w: the breakpoints come at pi/2w, pi/w, then each 3 pi/2w on; the motion is exact."""
    w = 3.0
    solution = explicit(two_springs(w**2), scheme, duration=6.0, points=601, rtol=1e-10)
    phase = np.mod(w * solution.time + np.pi / 2, 1.5 * np.pi)  # from a passage to the right on
    expected = np.where(phase < np.pi, np.sin(phase), -0.5 * np.sin(2 * (phase - np.pi)))
    np.testing.assert_allclose(solution["sled.x"], expected, atol=1e-8)
    passages = np.sort(
        np.concatenate([(np.pi / 2 + 1.5 * np.pi * np.arange(6)) / w, (np.pi + 1.5 * np.pi * np.arange(6)) / w])
    )
    passages = passages[passages < 6.0]
    assert solution.solver["events"] == len(passages)
    for t in passages:
        assert np.min(np.abs(solution.step_times - t)) < 1e-8


@pytest.mark.parametrize("scheme", ADAPTIVE)
def test_rows_between_an_event_and_the_output_times_are_those_of_bdf(scheme, examples):
    scene = stiffmbs.load_scene(examples / "bouncing_ball.yaml")
    found, expected = explicit(scene, scheme, rtol=1e-9, duration=1.0), stiffmbs.run(scene, rtol=1e-10, duration=1.0)
    np.testing.assert_array_equal(found.time, expected.time)
    np.testing.assert_allclose(found["ball.y"], expected["ball.y"], atol=1e-6)
    own = explicit(scene, scheme, rtol=1e-9, duration=1.0, points="steps")
    assert np.all(np.diff(own.time) > 0)
    assert len(own.time) == own.solver["steps"] + 1


@pytest.mark.parametrize("scheme", ADAPTIVE)
@pytest.mark.parametrize("duration", [1e2, 1e4, 1e7])
def test_a_jump_is_passed_where_the_shortest_step_is_too_long_for_its_error(scheme, duration):
    """The shortest step is a part of the duration: over a jump of 5 m/s^2 it has an error far above 1e-12 m/s."""
    model = Model()
    model.add("sled", Body(mass=1, inertia=1, velocity=(1, 0)))
    model.add("push", AppliedForce(i="sled", force=("branch(sled.x - 0.5, 5, 0, 0)", 0)))
    solution = explicit(model, scheme, duration=duration, points=2, rtol=1e-12)
    assert solution.outcome is Outcome.DONE
    speed = np.sqrt(1 + 2 * 5 * 0.5)
    assert solution["sled.vx"][-1] == pytest.approx(speed, rel=1e-11)
    assert solution["sled.x"][-1] == pytest.approx(0.5 + speed * (duration - (speed - 1) / 5), rel=1e-11)


@pytest.mark.parametrize("scheme", ADAPTIVE)
@pytest.mark.parametrize("part", [1e-2, 1e-3])
def test_a_change_is_passed_that_rounding_hides_for_a_while(scheme, part):
    """Within 2 mm/s of its way up to 10 m/s the sled has a part of its acceleration: it leaves that range by less than a
    rounding of its velocity in the time by which steps go past an event."""
    model = Model()
    model.add("sled", Body(mass=1, inertia=1))
    law = f"10*(1 - {1 - part}*branch(abs(sled.vx - 4.9991) - 0.001, 1, 0, 0))"
    model.add("push", AppliedForce(i="sled", force=(law, 0)))
    lost = 0.002 / 10 * (1 / part - 1)
    solution = explicit(model, scheme, duration=1.0, points=2, rtol=1e-6)
    assert solution.outcome is Outcome.DONE
    assert solution["sled.vx"][-1] == pytest.approx(10 - 10 * lost, rel=1e-6)


def test_a_start_on_a_corner_is_no_event():
    """The sled starts at x = 0 and leaves to one side."""
    model = two_springs(4.0)
    sled = Model()
    sled.add("sled", Body(mass=1, inertia=1, position=(0, 0), velocity=(1, 0)))
    for name, joint in model.data().joints.items():
        sled.add(name, joint)
    for name, force in model.data().forces.items():
        sled.add(name, force)
    assert explicit(sled, duration=1.0, rtol=1e-8).solver["events"] == 0


def test_dry_friction_that_jumps_is_told_at_rest():
    """A block of 1 kg under 5 N of friction comes to rest at 0.2 s; sign(v) then has no value that keeps it there."""
    model = Model()
    model.add("block", Body(mass=1, inertia=1, velocity=(1, 0)))
    model.add("rail", Prismatic(i="block", j="ground"))
    model.add("rubbing", AppliedForce(i="block", force=("-5*sign(block.vx)", 0)))
    solution = explicit(model, duration=1.0, points=101)
    assert solution.outcome is Outcome.STOPPED
    assert "'rubbing'" in solution.message and "t = 0.2" in solution.message
    moving = solution.time < 0.2
    np.testing.assert_allclose(solution["block.x"][moving], (solution.time - 2.5 * solution.time**2)[moving], atol=1e-7)


def test_fixed_steps_tell_that_they_do_not_locate_corners():
    notes = {
        scheme: " ".join(explicit(dropped_ball(stiffness=1e5), scheme, duration=0.1, step=1e-3).notes)
        for scheme in ("rk4", "dop853")
    }
    assert "does not locate" in notes["rk4"]
    assert "does not locate" not in notes["dop853"]


def test_a_spring_alone_has_no_events():
    model = Model()
    model.add("sled", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("spring", SpringDamper(i="sled", j="ground", stiffness=10, free_length=0.5))
    assert explicit(model, duration=1.0).solver["events"] == 0


def test_a_scene_without_breakpoints_has_no_note_on_them(examples):
    """A rolling disc has sines of angles, whose periods are no breakpoints."""
    found = stiffmbs.run(
        examples / "rolling_disc.yaml", solver="projected", scheme="rk4", step=1e-3, duration=0.02, errors=False
    )
    assert not any("does not locate" in note for note in found.notes)
