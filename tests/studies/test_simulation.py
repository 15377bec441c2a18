"""Stepping: the same motion as in one run, and inputs that jump between steps."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, InputError, Model, simulation
from stiffmbs.studies.stepping import ImplicitSteps
from tests.stress.families.stiffness.stiffness import bar_on_bushing

SLED = """
parameters: {F: 0 N, k: 100 N/m}
gravity: [0, -9.81]
bodies: {sled: {mass: 2, inertia: 1}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  push: {type: force, i: sled, force: [F, 0]}
  spring: {type: force, i: sled, force: ["-k*sled.x", 0]}
run: {duration: 2, rtol: 1e-9}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["bdf", "projected"])
@pytest.mark.parametrize("name", ["cart_pendulum.yaml", "half_car.yaml", "bouncing_ball.yaml", "heavy_top.yaml"])
def test_steps_give_the_states_of_one_run(examples, name, solver):
    settings = {"duration": 1.0, "rtol": 1e-10, "solver": solver, "points": 101}
    expected, sim = stiffmbs.run(examples / name, **settings), simulation(examples / name, **settings)
    channels = [channel for channel in expected if channel.rpartition(".")[2] in ("x", "y", "vx", "vy")]
    for k in range(1, 101):
        sim.step(0.01)
        assert sim.t == pytest.approx(expected.time[k], abs=1e-12)
        for channel in channels:
            assert sim[channel] == pytest.approx(expected[channel][k], abs=1e-8), (channel, k)


@pytest.mark.parametrize("stages", [3, 5, "auto"])
def test_failed_iterations_of_radau_do_not_restart_a_simulation(stages):
    """Each call takes one step, in which an iteration may fail; a run fails as often among many steps."""
    settings = {"duration": 1.0, "rtol": 1e-4, "solver": "radau", "stages": stages, "points": 11}
    expected, sim = stiffmbs.run(bar_on_bushing(1e7), **settings), simulation(bar_on_bushing(1e7), **settings)
    for k in range(1, 11):
        sim.step(0.1)
        for channel in ("bar.x", "bar.angle", "bar.omega"):
            assert sim[channel] == pytest.approx(expected[channel][k], abs=1e-9), (channel, k)


@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_driven_body_is_where_its_drive_is(solver):
    """Positions and velocities within a step of radau were those of its polynomial, off by 5e-5 m and 1e-3 m/s."""
    scene = """
        bodies: {b: {mass: 1, inertia: 1}}
        joints: {rail: {type: prismatic, i: b, j: ground}, motor: {type: drive, joint: rail, position: sin(5*t) + 0.2*sin(15*t)}}
        run: {duration: 10, points: 11, rtol: 1e-9}
        """
    sim = simulation(stiffmbs.read_scene(scene), solver=solver)
    for t in range(1, 11):
        sim.step(1.0)
        assert sim["b.x"] == pytest.approx(np.sin(5 * t) + 0.2 * np.sin(15 * t), abs=1e-8)
        assert sim["b.vx"] == pytest.approx(5 * np.cos(5 * t) + 3 * np.cos(15 * t), abs=1e-7)


@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_breakpoint_one_rounding_before_the_end_is_passed(solver, monkeypatch):
    """A run up to the duration ends at the breakpoint; steps beyond it go on from there."""
    begun = []

    def begin(self, start, t, own=ImplicitSteps._begin):
        begun.append(t)
        assert len(begun) < 10, "starts again and again"
        own(self, start, t)

    monkeypatch.setattr(ImplicitSteps, "_begin", begin)
    text = SLED.replace("force: [F, 0]", f'force: ["F*step(t, 0, 0, {float(np.nextafter(2.0, 0))!r}, 1)", 0]')
    sim = simulation(stiffmbs.read_scene(text), solver=solver)
    for _ in range(25):
        sim.step(0.1)
    assert sim.t == pytest.approx(2.5)


@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
def test_a_force_that_jumps_between_steps_moves_a_sled_as_it_should(solver):
    """m x'' + k x = F with F constant within each step: the exact solution, step by step."""
    sim = simulation(stiffmbs.read_scene(SLED), inputs={"F": 0.0}, solver=solver)
    w, x, v = np.sqrt(100.0 / 2), 0.0, 0.0
    for k in range(200):
        force = [0.0, 50.0, -30.0, -30.0][k % 4]
        sim.step(0.01, inputs={"F": force})
        rest = force / 100.0
        x, v = (
            rest + (x - rest) * np.cos(w * 0.01) + v / w * np.sin(w * 0.01),
            v * np.cos(w * 0.01) - (x - rest) * w * np.sin(w * 0.01),
        )
        assert sim["sled.x"] == pytest.approx(x, abs=1e-7)
        assert sim["sled.vx"] == pytest.approx(v, abs=1e-6)
        assert sim["rail.fy"] == pytest.approx(2 * 9.81, rel=1e-9)
    assert sim.inputs == {"F": -30.0}


def test_an_input_that_is_not_linear_in_a_force_is_followed_too():
    text = SLED.replace("force: [F, 0]", "force: [F^2/1 N, 0]").replace("-k*sled.x", "0*sled.x")
    sim = simulation(stiffmbs.read_scene(text), inputs={"F": 1.0})
    sim.step(1.0)
    sim.step(1.0, inputs={"F": 4.0})
    assert sim["sled.vx"] == pytest.approx(1 / 2 + 16 / 2, rel=1e-8)


@pytest.mark.parametrize("presolve", [True, False])
@pytest.mark.parametrize("used", [True, False])
def test_an_input_of_one_of_two_mechanisms_is_followed(presolve, used):
    """Mechanisms that the presolve solves apart, or would, are stepped together; an input may stand nowhere."""
    model = Model("two")
    model.add("pushed", Body(mass=1, inertia=1))
    model.add("other", Body(mass=1, inertia=1))
    model.add_input("push", 1.0)
    if used:
        model.add("motor", AppliedForce(i="pushed", force=("push", 0)))
    sim = stiffmbs.simulation(model, presolve=presolve)
    sim.step(0.5)
    sim.step(0.5, inputs={"push": 3.0})
    assert sim["pushed.x"] == pytest.approx(used * (0.125 + 0.25 + 0.375))


def test_a_reset_and_a_saved_state_go_on_as_before(tmp_path):
    sim = simulation(stiffmbs.read_scene(SLED), inputs={"F": 20.0})
    sim.step(0.3)
    sim.step(0.2, inputs={"F": 5.0})
    sim.save(tmp_path / "half.npz")
    halfway = sim["sled.x"]
    sim.step(0.5)
    end = sim["sled.x"]
    sim.reset()
    assert sim.t == 0 and sim.inputs == {"F": 20.0} and sim["sled.x"] == 0
    sim.load(tmp_path / "half.npz")
    assert sim.t == 0.5 and sim["sled.x"] == halfway and sim.inputs == {"F": 5.0}
    sim.step(0.5)
    assert sim["sled.x"] == pytest.approx(end, abs=1e-8)
    sim.reset()
    sim.step(0.3)
    sim.step(0.2, inputs={"F": 5.0})
    assert sim["sled.x"] == halfway


def test_a_run_starts_from_the_state_of_a_simulation(examples):
    path = examples / "cart_pendulum.yaml"
    sim = simulation(path, rtol=1e-9)
    sim.step(1.0)
    found = stiffmbs.run(path, start_from=sim.state, duration=1.0, rtol=1e-9)
    sim.step(1.0)
    assert found["bar.angle"][-1] == pytest.approx(sim["bar.angle"], abs=1e-7)


def test_a_model_built_in_python_is_stepped_beyond_its_duration():
    model = Model("Fall", gravity=(0, -10))
    model.add("ball", Body(mass=1, inertia=1))
    sim = model.simulation(duration=0.5)
    for _ in range(30):
        sim.step(0.1)
    assert sim["ball.y"] == pytest.approx(-45.0, abs=1e-4)
    assert sim["ball.ay"] == pytest.approx(-10.0)


def test_what_is_no_input_is_refused(examples):
    scene = stiffmbs.read_scene(SLED)
    with pytest.raises(
        InputError, match=r"input 'bodies\.sled\.mass': found an input that affects more than numbers of forces"
    ):
        simulation(scene, inputs={"bodies.sled.mass": 2.0})
    with pytest.raises(InputError, match="G: found no such parameter, expected one of F, k"):
        simulation(scene, inputs={"G": 2.0})
    sim = simulation(scene, inputs={"F": 0.0})
    with pytest.raises(InputError, match="input 'k': found no such input, expected one of F"):
        sim.step(0.1, inputs={"k": 2.0})
    with pytest.raises(InputError, match="input 'F': found nan"):
        sim.step(0.1, inputs={"F": float("nan")})
    with pytest.raises(InputError, match="found dt = 0"):
        sim.step(0)
    with pytest.raises(InputError, match=r"found no channel 'sled\.z'"):
        sim["sled.z"]


def test_a_parameter_that_a_change_adds_is_an_input(examples):
    added = [("parameters.u", "0 N"), ("forces.push", "{type: force, i: cart, force: [u, 0]}")]
    sim = simulation(stiffmbs.load_scene(examples / "cart_pendulum.yaml", added), inputs={"u": 0.0})
    sim.step(0.01, inputs={"u": 1000.0})
    assert sim["cart.vx"] > 0.1


PULSE = "1e4*(step(t, {at}, 0, {at} + 1e-4, 1) - step(t, {at} + 2e-4, 0, {at} + 3e-4, 1))"
"""Force of 1e4 N over 2e-4 s in the mean, which changes the velocity of the sled of 2 kg by 1 m/s."""


@pytest.mark.parametrize("at", ["F", "at"])
@pytest.mark.parametrize("solver", ["bdf", "radau", "projected"])
def test_a_pulse_whose_time_is_an_input_is_not_missed(solver, at):
    text = SLED.replace("F: 0 N", "F: 0").replace("force: [F, 0]", f'force: ["{PULSE.format(at=at)}", 0]')
    text = text.replace("-k*sled.x", "0*k*sled.x")
    scene = stiffmbs.read_scene("inputs: {at: 0}\n" + text)
    sim = simulation(scene, inputs={"F": 0.0} if at == "F" else None, solver=solver, duration=5.0)
    sim.step(0.3, inputs={at: 1.9})
    sim.step(0.7, inputs={at: 0.5})
    assert sim["sled.vx"] == pytest.approx(1.0, abs=1e-6)
    sim.step(0.5, inputs={at: 0.0})
    assert sim["sled.vx"] == pytest.approx(1.0, abs=1e-6)


def test_breakpoints_before_the_end_of_a_simulation_are_found_again_after_a_return(tmp_path):
    text = SLED.replace("force: [F, 0]", f'force: ["{PULSE.format(at="0.7")}", 0]').replace("-k*sled.x", "0*k*sled.x")
    sim = simulation(stiffmbs.read_scene(text), solver="bdf", duration=1.0)
    sim.step(0.4)
    sim.save(tmp_path / "early.npz")
    for _ in range(6):
        sim.step(0.3)  # beyond the duration
    assert sim["sled.vx"] == pytest.approx(1.0, abs=1e-6)
    sim.load(tmp_path / "early.npz")
    sim.step(0.5)
    assert sim["sled.vx"] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("law", "value"),
    [
        ("max(F, 2000)", lambda F: max(F, 2000)),
        ("abs(F - 5000)", lambda F: abs(F - 5000)),
        ("2*min(F, 1500)", lambda F: 2 * min(F, 1500)),
        ("F + step(F, 2000, 0, 3000, 1000)", lambda F: F + 1000 * (F > 3000)),
        ("F + max(0, 1 - abs(F - 5))", lambda F: F + max(0, 1 - abs(F - 5))),
        ("F/2 + k", lambda F: F / 2 + 100),
        ("max(F, limit)", lambda F: max(F, 2000)),
        ("max(F, 1000*pi)", lambda F: max(F, 1000 * np.pi)),
        ("abs(F/1000)^pi", lambda F: abs(F / 1000) ** np.pi),
        ("atan2(F, pi)", lambda F: np.arctan2(F, np.pi)),
        ("(F + 1)*max(limit, 1000*pi)/pi", lambda F: 1000 * (F + 1)),
    ],
)
def test_an_input_in_a_function_is_not_taken_as_linear(law, value):
    text = SLED.replace("force: [F, 0]", f'force: ["{law}", 0]').replace(
        "parameters: {F: 0 N", "variables: {limit: 2000}\nparameters: {F: 0"
    )
    sim = simulation(stiffmbs.read_scene(text.replace("100 N/m", "100")), inputs={"F": 0.0})
    for F in (0.0, 6000.0, 5.0, -3.0):
        sim.step(1e-9, inputs={"F": F})
        assert 2 * sim["sled.ax"] == pytest.approx(value(F), rel=1e-6, abs=1e-6)


def test_an_input_of_a_part_in_a_function_is_not_taken_as_linear():
    part = """
parts:
  pull:
    parameters: {G: 0}
    mounts: {on: ground}
    forces: {f: {type: force, i: on, force: ["G + max(G, 2000)", 0]}}
  p: {use: pull, parameters: {G: F}, mounts: {on: sled}}
"""
    text = SLED.replace("force: [F, 0]", "force: [0, 0]").replace("parameters: {F: 0 N", "parameters: {F: 0") + part
    sim = simulation(stiffmbs.read_scene(text.replace("100 N/m", "100")), inputs={"F": 0.0})
    for F in (0.0, 5.0, -3.0, 6000.0):
        sim.step(1e-9, inputs={"F": F})
        assert 2 * sim["sled.ax"] == pytest.approx(F + max(F, 2000), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("law", ["F*cos(t)", "F*abs(F)", "F*dx(sled)*cos(t)"])
@pytest.mark.parametrize("own", [True, False])
def test_an_input_returns_to_its_first_value(own, law):
    """As a parameter and as an input of the model, set to and fro, and by a reset."""
    text = SLED.replace("F: 0 N, k: 100 N/m", "F: 10" if not own else "other: 0").replace("-k*sled.x", "0*sled.x")
    text = text.replace("force: [F, 0]", f'force: ["{law}", 0]')
    text = text.replace("inertia: 1}", "inertia: 1, position: [1, 0]}") + ("inputs: {F: 10}\n" if own else "")
    sim = simulation(stiffmbs.read_scene(text), inputs=None if own else {"F": 10.0})
    start = sim["sled.ax"]
    for F in (10.0, 20.0, 10.0, 3.0, 10.0):
        sim.set_inputs({"F": F})
        assert 2 * sim["sled.ax"] == pytest.approx(F * abs(F) if "abs" in law else F, rel=1e-9)
    sim.step(0.1)
    first = sim["sled.vx"]
    sim.set_inputs({"F": 20.0})
    sim.reset()
    assert sim.inputs == {"F": 10.0} and sim["sled.ax"] == start
    sim.step(0.1)
    assert sim["sled.vx"] == pytest.approx(first, rel=1e-8)


BUSHING = """
dimensions: 3
parameters: {k: 10 N/m}
bodies: {sled: {mass: 1, inertia: [1, 1, 1], position: [1, 0, 0]}}
forces:
  bush: {type: bushing, i: {body: sled, point: [0, 0, 0]}, j: {body: ground, point: [0, 0, 0]}, stiffness: [k, 5, 5, 1, 1, 1]}
"""


def test_a_value_that_changes_the_equations_is_refused():
    sim = simulation(stiffmbs.read_scene(BUSHING), inputs={"k": 10.0})
    sim.set_inputs({"k": 3.0})
    with pytest.raises(InputError, match="input 'k': found 0, which changes more than numbers of forces"):
        sim.set_inputs({"k": 0.0})
    assert sim.inputs == {"k": 3.0} and sim["sled.ax"] == pytest.approx(-3.0)
    sim.set_inputs({"k": 1.0})
    assert sim["sled.ax"] == pytest.approx(-1.0)


def test_an_invalid_value_leaves_the_inputs_as_they_were():
    text = SLED.replace("F: 0 N", "F: 4").replace("force: [F, 0]", "force: [sqrt(F), 0]")
    sim = simulation(stiffmbs.read_scene(text), inputs={"F": 4.0})
    with pytest.raises(InputError, match=r"push: found 'sqrt\(F\)'"):
        sim.set_inputs({"F": -1.0})
    assert sim.inputs == {"F": 4.0} and sim["sled.ax"] == pytest.approx(1.0)


def test_a_scene_refuses_inputs_as_it_refuses_values_in_its_text(examples):
    """Inputs beyond the values at which their linearity was tested are read with the scene, once for many."""
    stiffness = "forces.spring.stiffness"
    sim = simulation(examples / "cart_pendulum.yaml", inputs={stiffness: 270.0})
    with pytest.raises(
        InputError, match=r"input 'forces\.spring\.stiffness': found 1e\+300, expected a size below 1e\+100"
    ):
        sim.step(0.01, {stiffness: 1e300})
    read, own = [], sim._inputs._solver.scene
    sim._inputs._solver.scene = lambda values: read.append(values) or own(values)
    for k in range(100):
        sim.step(1e-6, {stiffness: 2e3 + 10.0 * k})
    assert len(read) == 2 and sim.inputs == {stiffness: 2990.0}


@pytest.mark.parametrize("settings", [{"solver": "bdf"}, {"solver": "projected", "scheme": "rk4", "step": 0.01}])
def test_steps_end_before_a_row_that_the_scene_refuses(settings):
    text = SLED.replace("F: 0 N", "F: 4").replace("force: [F, 0]", "force: [sqrt(F), 0]")
    sim = simulation(stiffmbs.read_scene(text), inputs={"F": 4.0}, **settings)
    with pytest.raises(InputError, match=r"row 2 of the inputs: push: found 'sqrt\(F\)'"):
        sim.steps(4, [[1.0], [9.0], [-1.0], [2.0]], 0.01)
    assert sim.t == pytest.approx(0.02) and sim.inputs == {"F": 9.0}
    with pytest.raises(InputError, match=r"input 'F': found nan in row 1"):
        sim.steps(2, [[1.0], [float("nan")]], 0.01)
    assert sim.t == pytest.approx(0.02) and sim.inputs == {"F": 9.0}


@pytest.mark.parametrize("settings", [{"solver": "bdf"}, {"solver": "projected", "scheme": "rk4", "step": 0.01}])
def test_compiled_steps_end_before_such_a_row(settings, monkeypatch):
    """The input is linear, and large values of it are refused; rows before are taken in one call."""
    sim = simulation(stiffmbs.read_scene(SLED), inputs={"F": 0.0}, **settings)
    own = sim._inputs._scene

    def scene(values):
        if values["F"] > 5000.0:
            raise InputError("push: found a large force")
        return own(values)

    monkeypatch.setattr(sim._inputs, "_scene", scene)
    with pytest.raises(InputError, match="row 2 of the inputs: push: found a large force"):
        sim.steps(4, [[1.0], [4000.0], [6000.0], [2.0]], 0.01)
    assert sim.t == pytest.approx(0.02) and sim.inputs == {"F": 4000.0}
    with pytest.raises(InputError, match="push: found a large force"):
        sim.step(0.01, {"F": 6000.0})
    assert sim.t == pytest.approx(0.02) and sim.inputs == {"F": 4000.0}
