"""Runs with many events, between which errors add up, have an estimate by default."""

from stiffmbs import AppliedForce, Body, Model


def test_errors_of_many_events_are_estimated():
    """A soft stop is touched for a thousandth of an amplitude in each of 32 periods, by BDF's errors in amplitude or not."""
    model = Model(gravity=(0, 0))
    model.add("q", Body(mass=1, inertia=1, position=(1, 0)))
    model.add("b", Body(mass=1, inertia=1, position=(0, 1)))
    model.add("spring", AppliedForce(i="q", force=("-200^2*q.x", 0)))
    model.add("push", AppliedForce(i="b", force=("37642*max(q.x - 0.998, 0)", 0)))
    found = model.run(duration=1, points=2, solver="bdf", rtol=1e-4)
    assert found.solver["events"] > 40
    assert any("error" in note for note in found.notes)
