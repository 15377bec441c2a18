"""Limits of sensitivities: what is refused, steps of motions at rest, derivatives of what is zero up to rounding."""

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, SolverError, sensitivities
from stiffmbs.sensitivity_equations.recorded import Recorder, Segment
from stiffmbs.studies.sensitivities.formulas import Formula
from stiffmbs.studies.sensitivities.sensitivities import Sensitivity, _agree
from tests.studies.oscillator import SLED, oscillation, slope


@pytest.mark.parametrize(
    ("to", "of", "message"),
    [
        (["nothing"], "final(sled.x)", "expected a parameter of the scene"),
        (["k", "k"], "final(sled.x)", "each once"),
        (["bodies.sled.position"], "final(sled.x)", "add a place such as .0"),
        (["bodies.sled.position.5"], "final(sled.x)", "a place of the vector"),
        (["bodies.sled.position.x"], "final(sled.x)", "position.x"),
        (["k"], "final(sled.q)", "no channel 'sled.q'"),
        (["k"], "t_peak(sled.x)", "found t_peak"),
        (["k"], "final(constraint.position)", "has no derivatives"),
        (["run.rtol"], "final(sled.x)", "expected a parameter of the scene"),
    ],
)  # fmt: skip
def test_what_cannot_be_differentiated_is_refused(to, of, message):
    with pytest.raises(InputError, match=message):
        sensitivities(stiffmbs.read_scene(SLED), to, of)


def test_a_run_that_stops_early_has_none():
    text = SLED.replace('"-k*sled.x - c*sled.vx"', '"sqrt(1 - t)"')
    with pytest.raises(SolverError, match="the run stopped"):
        sensitivities(stiffmbs.read_scene(text.replace("k: 100 N/m, c: 1 N s/m, ", "")), ["m"], "final(sled.x)")


FALLING = """
parameters: {g: 0 m/s^2, tilt: 0, k: 100 N/m}
bodies: {sled: {mass: 2 kg, inertia: 1, position: [0.1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: force, i: sled, force: ["-k*sled.x", 0]}
run: {duration: 2, rtol: 1e-7, points: 41}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("gravity", "to", "factor"),
    [
        ("", "gravity.0", 1.0),
        ("gravity: [0, 0]", "gravity.0", 1.0),
        ("gravity: [g, 0]", "g", 1.0),
        ("gravity: [0, g]", "g", 0.0),
        ("gravity: ['-g/2', g]", "g", -0.5),
        ("gravity: ['9.81*sin(tilt)', 0]", "tilt", 9.81),
        ("gravity: [0, 9.81]", "gravity.0", 1.0),
    ],
)
def test_those_by_gravity_that_is_zero(gravity, to, factor):
    """The sled oscillates about m g/k: dx/dg = m/k (1 - cos(w t)); that by the stiffness is not affected."""
    found = sensitivities(stiffmbs.read_scene(FALLING + gravity), [to, "k"], "sled.x")
    w = np.sqrt(100 / 2)
    np.testing.assert_allclose(found.to[to], factor * 2 / 100 * (1 - np.cos(w * found.time)), atol=1e-7)
    by_k = slope(lambda k: oscillation(found.time, k=k, c=0.0), "k", 100.0)
    np.testing.assert_allclose(found.to["k"], by_k, atol=1e-8)


def test_gravity_that_vanishes_by_chance_is_named():
    scene = stiffmbs.read_scene(FALLING.replace("tilt: 0", "tilt: 1") + "gravity: ['tilt - 1', 0]")
    with pytest.raises(InputError, match="no body has a weight where gravity is zero"):
        sensitivities(scene, "tilt", "sled.x")


def test_a_motion_that_chatters_is_not_solved_a_second_time(monkeypatch):
    """No motion follows a force against the velocity that jumps, with any tolerance."""
    solved, module = [], import_module("stiffmbs.studies.sensitivities.sensitivities")
    prepare = module.prepare
    monkeypatch.setattr(
        module, "prepare", lambda scene, settings: solved.append(settings.rtol) or prepare(scene, settings)
    )
    text = SLED.replace("- c*sled.vx", "- 20*sign(sled.vx)")
    with pytest.raises(SolverError, match="chatters"):
        sensitivities(stiffmbs.read_scene(text.replace("c: 1 N s/m, ", "")), ["k"], "final(sled.x)")
    assert len(solved) == 1


AT_REST = """
parameters: {{A: 0, k: {k}}}
bodies: {{b: {{mass: 2, inertia: 1, velocity: [{v}, 0]}}}}
joints: {{r: {{type: prismatic, i: b, j: ground}}}}
forces: {{f: {{type: force, i: b, force: ["{law}", 0]}}}}
run: {{duration: 1, rtol: 1e-7}}
"""


@pytest.mark.sampled(5)
@pytest.mark.parametrize("v", [0.0, 3.0])
@pytest.mark.parametrize(
    ("law", "k", "exact"),
    [
        ("A", 0.0, 0.25),
        ("A*sin(10*t)", 0.0, (1 - np.sin(10) / 10) / 20),
        ("A - k*(b.x - {v}*t)", 50.0, (1 - np.cos(5)) / 50),
    ],
)
def test_a_motion_at_rest_or_steady_has_short_enough_steps(law, k, exact, v):
    """The error control of such a motion limits no step, but its variation needs short ones."""
    scene = stiffmbs.read_scene(AT_REST.format(law=law.format(v=v), k=k, v=v))
    assert stiffmbs.sensitivities(scene, "A", "final(b.x)").to["A"] == pytest.approx(exact, rel=1e-3)


@pytest.mark.long
def test_a_vibration_that_no_step_resolves_is_refused():
    scene = stiffmbs.read_scene(AT_REST.format(law="A - k*b.x", k=5e4, v=0))
    with pytest.raises(SolverError, match="102400 steps do not resolve how 'final"):
        stiffmbs.sensitivities(scene, "A", "final(b.x)")


@pytest.mark.long
def test_an_event_of_an_algebraic_state_takes_the_law_behind_it():
    """The branch has another value at zero than on both sides; the time of the event changes by -1/z'(0) with the start."""
    start = -0.0685166
    scene = stiffmbs.read_scene(f"""
gravity: [0, 0]
parameters: {{start: {start}}}
bodies: {{b: {{mass: 1, inertia: 1}}}}
states: {{p: {{zero: "2*p - z", start: 0}}, z: {{rate: "0.2 - p*z", start: start}}}}
forces: {{f: {{type: force, i: b, force: ["branch(p + 0.0124121, 15.9, 0, 6.5)", 0]}}}}
run: {{duration: 0.5, points: 3}}
""")
    found = sensitivities(scene, of="final(b.vx)", to="start")
    assert found.to["start"] == pytest.approx(-(15.9 - 6.5) / (0.2 - start**2 / 2), rel=1e-4)


@pytest.mark.parametrize(("size", "slope"), [(1e-17, 0.0), (0.7e-14, 0.0), (1.5e-14, 0.1), (1e-12, 0.1)])
def test_the_magnitude_of_what_is_zero_up_to_rounding_has_the_mean_of_both_slopes(size, slope):
    t = np.linspace(0, 1, 11)
    x = size * np.where(np.arange(11) < 6, 1.0, -1.0)
    found = Formula("integral(abs(x))", t, {"x": x}).dual({"x": np.ones((11, 1))})
    assert found.slope == pytest.approx([slope], abs=1e-12)


@pytest.mark.parametrize(("size", "slope"), [(0.0, 0.0), (1e-17, 0.0), (0.7e-14, 0.0), (1.5e-14, 1.0), (1e-3, 1.0)])
def test_the_rms_of_what_is_zero_up_to_rounding_has_the_mean_of_both_slopes(size, slope):
    t = np.linspace(0, 1, 11)
    found = Formula("rms(x)", t, {"x": np.full(11, size)}).dual({"x": np.ones((11, 1))})
    assert found.slope == pytest.approx([slope], abs=1e-12)


@pytest.mark.parametrize("reduction", ["max", "min", "peak"])
def test_an_extremum_of_what_is_zero_up_to_rounding_has_no_single_time(reduction):
    t = np.linspace(0, 1, 11)
    x = 1e-17 * np.sin(np.arange(11))
    with pytest.raises(SolverError, match=f"has its {reduction} at 11 output times"):
        Formula(f"{reduction}(x)", t, {"x": x}).dual({"x": t[:, None]})


@pytest.mark.long
def test_coordinates_at_rest_have_no_jumps():
    """A door on a vertical hinge: the accelerations of its other coordinates are rounding."""
    k, inertia = 15.0, 7 + 20 * 0.45**2
    scene = stiffmbs.read_scene("""
        dimensions: 3
        gravity: [0, 0, -9.81]
        bodies: {door: {mass: 20, inertia: [6, 1.5, 7], position: [0.45, 0, 0], velocity: [0, 0.9, 0], omega: [0, 0, 2]}}
        joints: {hinge: {type: revolute, i: {body: door, point: [-0.45, 0, 0]}, j: ground}}
        forces: {spring: {type: torsion_spring, i: {body: door, point: [-0.45, 0, 0]}, j: ground, stiffness: 15}}
    """)
    found = sensitivities(scene, ["forces.spring.stiffness"], "final(door.wz)", duration=1.0).to[
        "forces.spring.stiffness"
    ]
    w = np.sqrt(k / inertia)
    assert found == pytest.approx(-2 * np.sin(w) / (2 * w * inertia), rel=1e-5)


@pytest.mark.parametrize(
    ("jumps", "width", "around", "size", "refused"),
    [
        ((0.5, 0.0), 1e-4, 0.0, 0.05, True),
        ((0.5, 0.0), 1.3e-3, 0.0, 0.05, True),
        ((0.5, 0.0), 2.9e-3, 0.0, 0.05, False),
        ((0.5, 0.0), 1e-2, 0.0, 0.05, False),  # steep, but continuous
        ((0.5, 0.0), 1.0, 0.0, 0.05, False),
        ((1.5e-3, 0.0), 1e-4, 0.0, 0.05, True),
        ((0.7e-3, 0.0), 1e-4, 0.0, 0.05, False),
        ((0.0, 1.5e-6), 1e-4, 0.0, 0.05, True),
        ((0.0, 0.7e-6), 1e-4, 0.0, 0.05, False),  # below a millionth of the other coordinate's acceleration
        ((0.5, 0.0), 1e-4, 0.0, 0.07, True),
        ((0.5, 0.0), 1e-4, 0.0, 0.15, False),  # errors of a jump shorten the steps
        ((0.5, 0.0), 1e-4, 0.5 / 15, 0.05, True),
        ((0.5, 0.0), 1e-4, 0.5 / 7, 0.05, False),  # accelerations change so much in the steps around it, too
    ],
)
def test_a_jump_of_accelerations_is_refused_from_a_size_on(jumps, width, around, size, refused):
    """Accelerations of about 1 and 0 change by `jumps` within a part of a step; around it, the first one changes as fast as by `around` in such a step.

    `size`: of the step relative to those around it.
    """
    h = 0.01 * size
    t = 0.5 + np.array([-0.03, -0.02, -0.01, 0.0, h, h + 0.01, h + 0.02])

    def accelerations(at, _):
        passed = np.clip((at - 0.5 - 0.37 * h) / (h * width), 0, 1) if width < 1 else np.clip((at - 0.5) / h, 0, 1)
        return np.array([1.0, 0.0]) - np.array(jumps) * (1 - passed) - [around * min(at - 0.5, 0.0) / h, 0.0]

    recorder = Recorder.__new__(Recorder)
    recorder.equations = SimpleNamespace(n=2, at={"u": np.arange(2)})
    recorder.dynamics = SimpleNamespace(system=SimpleNamespace(size=1.0, per_velocity=lambda *_: np.ones(2)))
    recorder._accelerations = accelerations
    recorder._all_accelerations = lambda rows: np.array([accelerations(row[0], None) for row in rows])
    rows = np.array([[at, 1.0, 0.0, 0.0, *accelerations(at, None)] for at in t])
    recorder.segments = [Segment(None, rows[0], [rows])]
    if refused:
        with pytest.raises(SolverError, match="discontinuous"):
            recorder.passed(1.0)
    else:
        recorder.passed(1.0)


THROUGH_ITS_ANCHOR = """
parameters: {m: 1.3 kg}
bodies: {sled: {mass: m, inertia: 1, position: [0, 0]}}
forces:
  held: {type: spring_damper, i: sled, j: {body: ground, point: [-0.74, 0.92]}, stiffness: 88, damping: 0.2, free_length: 0.3}
run: {duration: 0.5, points: 6}
"""


@pytest.mark.parametrize("solver", ["bdf", "radau"])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
def test_a_spring_that_passes_its_anchor_is_refused_by_every_solver(solver, rtol):
    with pytest.raises(SolverError, match="passes its anchor"):
        sensitivities(stiffmbs.read_scene(THROUGH_ITS_ANCHOR), ["m"], "final(sled.x)", solver=solver, rtol=rtol)


ON_A_KINK = """
gravity: [0, 0]
parameters: {push: 0 N, edge: 0 m/s, c: 3 N s/m}
bodies:
  a: {mass: 2, inertia: 1}
  b: {mass: 1, inertia: 1, position: [1, 0], velocity: [0.1, 0]}
forces:
  pushed: {type: force, i: a, force: [push, 0]}
  follows: {type: force, i: b, force: ["-c*LAW", 0]}
run: {duration: 1, points: 5}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
@pytest.mark.parametrize("to", ["push", "edge"])
@pytest.mark.parametrize("law", ["max(a.vx - edge, 0)", "abs(a.vx - edge)"])
def test_a_parameter_that_moves_a_body_off_a_kink_has_no_derivative(law, to, solver):
    with pytest.raises(SolverError, match="stays on its breakpoint"):
        sensitivities(stiffmbs.read_scene(ON_A_KINK.replace("LAW", law)), [to], "final(b.vx)", solver=solver)


@pytest.mark.parametrize("law", ["(max(a.vx, 0) + min(a.vx, 0))", "branch(a.vx, a.vx, 0, a.vx)"])
def test_breakpoints_that_cancel_are_refused_where_a_body_stays_on_them(law):
    """On the breakpoint itself the derivatives of max and min are 1, and that of branch is of its middle value."""
    with pytest.raises(SolverError, match="those of neither side"):
        sensitivities(stiffmbs.read_scene(ON_A_KINK.replace("LAW", law)), ["push"], "final(b.vx)")


@pytest.mark.parametrize(("edge", "refused"), [(0.7e-12, True), (1.5e-12, False)])
def test_a_breakpoint_counts_as_touched_up_to_rounding(edge, refused):
    scene = stiffmbs.read_scene(ON_A_KINK.replace("LAW", "max(a.vx - edge, 0)").replace("edge: 0", f"edge: {edge!r}"))
    if refused:
        with pytest.raises(SolverError, match="stays on its breakpoint"):
            sensitivities(scene, ["push"], "final(b.vx)")
    else:
        assert sensitivities(scene, ["push"], "final(b.vx)").to["push"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.long
def test_a_law_with_a_zero_slope_at_its_breakpoint_has_a_derivative():
    """Its second difference grows with the square of the displacement."""
    law = ON_A_KINK.replace("c: 3 N s/m", "c: 3e4 N s^2/m^2").replace("LAW", "max(a.vx, 0)^2")
    assert sensitivities(stiffmbs.read_scene(law), ["push"], "final(b.vx)").to["push"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.long
def test_a_body_that_moves_along_a_kink_has_one():
    scene = stiffmbs.read_scene(ON_A_KINK.replace("LAW", "max(a.vy, 0)"))
    found = [sensitivities(scene, ["push"], f"final({body}.vx)").to["push"] for body in ("a", "b")]
    assert found == pytest.approx([0.5, 0.0], abs=1e-9)


@pytest.mark.parametrize("of", [["final(a.x)", "final(a.y)"], ("final(a.x)",), 3])
def test_an_output_that_is_no_text_is_refused(of):
    scene = stiffmbs.read_scene("{bodies: {a: {mass: 1, inertia: 1}}}")
    with pytest.raises(stiffmbs.InputError, match=r"of: found .*, expected the text of one formula"):
        sensitivities(scene, "bodies.a.mass", of)


STRETCHED_PENDULUM = """
gravity: [0, 0]
parameters: {k: 88.7 N/m, l: 0.37}
bodies:
  a: {mass: 0.37, inertia: 0.1, position: [l*cos(0.7), l*sin(0.7)], angle: 0.7, markers: {p: {point: [-l, 0]}, e: {point: [l, 0]}}}
  b: {mass: 0.37, inertia: 0.1, position: [3*l*cos(0.7), 3*l*sin(0.7)], angle: 0.7, markers: {p: {point: [-l, 0]}, e: {point: [l, 0]}}}
joints:
  p: {type: revolute, i: a.p, j: ground}
  q: {type: revolute, i: b.p, j: a.e}
forces:
  along: {type: spring_damper, i: b.e, j: {body: ground, point: [6*l*cos(0.7), 6*l*sin(0.7)]}, stiffness: k, damping: 0.2, free_length: 0.3}
run: {duration: 0.001, points: 6}
"""


@pytest.mark.long
def test_steps_are_not_refined_for_the_rounding_of_a_derivative_of_zero(monkeypatch):
    """A force along the stretched links does not rotate them: outputs and derivatives are rounding, which never agrees."""
    module, numbers = import_module("stiffmbs.studies.sensitivities.sensitivities"), []
    solved = module.differentiated
    monkeypatch.setattr(module, "differentiated", lambda *given: numbers.append(given[-1]) or solved(*given))
    for of in ("final(a.omega)", "final(b.omega)"):
        found = sensitivities(stiffmbs.read_scene(STRETCHED_PENDULUM), ["k"], of, solver="radau")
        assert found.to["k"] == pytest.approx(0.0, abs=1e-15)
    assert max(numbers) <= 400


@pytest.mark.parametrize(
    ("value", "size", "coarse", "fine", "same"),
    [
        (1e-22, 0.02, 1e-21, 6e-21, True), (0.0, 2e11, 4e-15, 5e-15, False), (0.0, 1.0, 1.0, 1.1, False),
        (1e-3, 1.0, 1.0, 1.1, False), (0.0, 0.0, 1e-21, 6e-21, False),
    ],
)  # fmt: skip
def test_derivatives_of_zero_agree_if_the_whole_parameter_changes_the_output_by_rounding(
    value, size, coarse, fine, same
):
    one, other = (Sensitivity("final(a.x)", value, {"k": slope}, np.zeros(1)) for slope in (coarse, fine))
    assert _agree(1e-4, {"k": size}, one, other) is same
