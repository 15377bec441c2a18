"""A run says that it stopped where results end before its duration."""

from dataclasses import replace

import stiffmbs
from stiffmbs import Body, Model, Revolute
from stiffmbs.solve.mechanics import Mechanics
from stiffmbs.solve.native.statuses import NO_BALANCE
from stiffmbs.solve.trajectory import Outcome


def test_states_without_reactions_stop_the_run(monkeypatch):
    report = Mechanics.report

    def none_after_the_fifth(self, t, q, u, project):
        return replace(report(self, t[:5], q[:5], u[:5], project), status=NO_BALANCE)

    monkeypatch.setattr(Mechanics, "report", none_after_the_fifth)
    model = Model(gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1, inertia=0.1, position=(0.3, 0)))
    model.add("hinge", Revolute(i=bar.at(-0.3, 0), j="ground"))
    solution = stiffmbs.run(model, duration=1.0, points=11)
    assert len(solution.time) == 5
    assert solution.outcome is Outcome.STOPPED
    assert "t = 0.5 s" in solution.message
    assert "friction" in solution.message
