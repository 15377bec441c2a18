"""Sensitivities of every kind of channel after events: identities between channels, and differences of converged runs."""

import json

import pytest

import stiffmbs
from stiffmbs import SolverError, sensitivities
from stiffmbs.studies.outputs import outputs_of

SPRING = "-k*cart.x - c*cart.vx"
NUMBERS = {"k": 40.0, "c": 1.0, "m": 2.0, "F": 20.0}


def cart(force, states=None, **more):
    """A cart on a spring with a further force."""
    return {
        "parameters": dict(NUMBERS),
        "gravity": [0, -9.81],
        "bodies": {"cart": {"mass": "m", "inertia": 1, "position": [0.1, 0]}},
        "joints": {"rail": {"type": "prismatic", "i": "cart", "j": "ground"}},
        "forces": {"push": {"type": "force", "i": "cart", "force": [force, 0]}},
        "states": states or {},
        "run": {"duration": 1, "rtol": 1e-7, "points": 11},
    } | more


def with_bar(found):
    """The same with a bar that swings below the cart, so that reactions vary."""
    found["bodies"]["bar"] = {"mass": 1, "inertia": 0.1, "position": [0.6, 0]}
    found["joints"]["hinge"] = {"type": "revolute", "i": {"body": "bar", "point": [-0.5, 0]}, "j": "cart"}
    return found


def read(found, **values):
    """The scene with other values of its parameters."""
    return stiffmbs.read_scene(json.dumps({**found, "parameters": {**found["parameters"], **values}}))


def differences(found, name, of):
    """By central differences of fourth order of converged runs."""
    (output,), value = outputs_of(of), found["parameters"][name]
    h = 1e-3 * value
    f = [
        output.value(stiffmbs.run(read(found, **{name: value + shift * h}), rtol=1e-11, solver="bdf"))
        for shift in (-2, -1, 1, 2)
    ]
    return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)


FOLLOWS = {"p": {"zero": "p - 5*cart.x - 1", "start": 1.5}}


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    "force",
    [
        f"{SPRING} - F*abs(cart.x - 0.03)",
        f"{SPRING} - F*max(0.02 - cart.x, 0) - branch(cart.x - 0.02, -c*cart.vx, 0, 0)",
        f"{SPRING} + branch(p - 1.2, F/4, 0, 0)",
        f"{SPRING} + branch(cart.vx + 0.1, -F/4, 0, 0)",
        f"{SPRING} + branch(t - 0.35, F/4, 0, 0)",
        f"{SPRING} - F*p*max(p - 1.1, 0)/10",
    ],
    ids=["kink", "contact", "jump at its value", "jump at a velocity", "jump in time", "of itself"],
)
def test_an_algebraic_state_follows_what_it_is_a_formula_of(force):
    scene = read(cart(force, FOLLOWS))
    of_state = sensitivities(scene, list(NUMBERS), "final(p)").to
    of_cart = sensitivities(scene, list(NUMBERS), "final(cart.x)").to
    assert of_state == pytest.approx({name: 5 * slope for name, slope in of_cart.items()}, rel=1e-9)
    assert all(of_state.values())


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "outputs"),
    [
        (
            cart(f"{SPRING} - F*abs(w - 0.1)", {
                "p": {"zero": "p - 5*cart.x", "start": 0.5}, "w": {"zero": "w*(1 + w*w) - p", "start": 0.5},
                "z": {"rate": "abs(w) - z", "start": 0},
            }),
            ["final(w)", "final(z)", "final(energy.total)"],
        ),
        (
            with_bar(cart(f"{SPRING} - F/60*abs(fy(rail) - 30)", {"z": {"rate": "abs(fy(rail) - 25)", "start": 0}})),
            ["final(cart.vx)", "final(rail.fy)", "final(z)"],
        ),
        (
            with_bar(cart(f"{SPRING} - F/2*abs(p)", {"p": {"zero": "p - fy(rail)/30 + 0.8 + 5*cart.x", "start": 1}})),
            ["final(p)", "final(hinge.fx)", "final(push.fx)"],
        ),
    ],
    ids=["two algebraic states", "kink of a reaction", "kink of a state that follows a reaction"],
)  # fmt: skip
def test_differences_of_converged_runs(scene, outputs):
    for of in outputs:
        found = sensitivities(read(scene), ["k", "F"], of)
        for name, slope in found.to.items():
            assert slope == pytest.approx(differences(scene, name, of), rel=1e-4, abs=1e-8), (of, name)


def test_the_energy_of_a_body_follows_its_mass():
    """A sled at speed v that no force acts on: energy.kinetic is m v^2/2."""
    scene = cart("0", joints={}, gravity=[0, 0])
    scene["bodies"]["cart"]["velocity"] = [3, 0]
    found = sensitivities(read(scene), ["m"], "final(energy.kinetic)")
    assert found.to["m"] == pytest.approx(4.5, rel=1e-9)


TABLE = {"lines": True, "table": [[-1, 0], [0.1, 1], [0.2, -1], [0.5, 2], [0.6, 0], [0.85, 1], [3, 1]]}


@pytest.mark.long
@pytest.mark.sampled(12)
@pytest.mark.parametrize("force", ["F*tab(t - s)", "F*tab(t/r)", "F*tab(t - s)*(1 - cart.vx/5)"])
@pytest.mark.parametrize(
    "of", ["integral(cart.x)", "integral(cart.ax)", "rms(cart.vx)", "mean(push.fx)", "final(cart.x)"]
)
def test_breakpoints_on_output_instants(force, of):
    """What bends at an output instant has the mean of both sides for its derivative, as central differences do."""
    scene = cart(f"{SPRING} + {force}", tables={"tab": TABLE})
    scene["parameters"] |= {"s": 0.0, "r": 1.0}
    for name in {"s", "r"} & set(force):
        slope = sensitivities(read(scene), [name], of).to[name]
        value = scene["parameters"][name]
        below, above = (
            outputs_of(of)[0].value(stiffmbs.run(read(scene, **{name: value + shift}), rtol=1e-11, solver="bdf"))
            for shift in (-1e-6, 1e-6)
        )
        assert slope == pytest.approx((above - below) / 2e-6, rel=1e-3, abs=1e-4)


@pytest.mark.long
def test_a_number_that_takes_a_channel_at_its_jump_is_refused():
    scene = cart("branch(t - s, F, 0, 0)")
    scene["parameters"] |= {"s": 0.4}
    assert sensitivities(read(scene), ["F"], "integral(cart.ax)").to["F"] == pytest.approx(0.35 / 2, rel=1e-9)
    for of in ("integral(cart.ax)", "mean(push.fx)"):
        for to in (["F", "s"], ["F", "m", "s"]):
            with pytest.raises(SolverError, match=r"is discontinuous at the output time t = 0\.4 s, and 's' moves"):
                sensitivities(read(scene), to, of)
    assert sensitivities(read(scene), ["s"], "final(cart.vx)").to["s"] == pytest.approx(10)
    assert sensitivities(read(scene), ["s"], "final(cart.ax)").to["s"] == pytest.approx(0, abs=1e-9)
    assert sensitivities(read(scene), ["s"], "cart.vx").to["s"][-1] == pytest.approx(10)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("over", [0.0, 1e-15, -1e-15, 1e-13, -1e-13, 1e-11, -1e-11])
@pytest.mark.parametrize(
    "law", ["branch(-cart.x - A + OVER, 0, 0, F)", "branch(-cart.vx - A*sqrt(k/m) + OVER, 0, 0, F)"]
)
def test_a_breakpoint_that_is_touched_but_for_errors_of_the_run_is_refused(law, over):
    scene = cart(f"-k*cart.x + {law}".replace("OVER", f"({over!r})"))
    scene["parameters"]["A"] = 0.1
    with pytest.raises(SolverError, match="'push' grazes its breakpoint"):
        sensitivities(read(scene), ["k"], "final(cart.x)")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("over", [1e-3, 1e-4, 1e-5, -1e-7, -1e-5])
def test_a_breakpoint_that_is_passed_by_more_than_errors_is_none_of_them(over):
    """The force acts from -A + over on: the motion before and after is a vibration about 0 and about F/k."""
    scene = cart(f"-k*cart.x + branch(-cart.x - A + ({over!r}), 0, 0, F)")
    scene["parameters"]["A"] = 0.1
    found = sensitivities(read(scene), ["k"], "final(cart.x)")
    expected = [
        stiffmbs.run(read(scene, k=40.0 + shift), rtol=1e-12, solver="bdf")["cart.x"][-1] for shift in (-1e-3, 1e-3)
    ]
    assert found.to["k"] == pytest.approx((expected[1] - expected[0]) / 2e-3, rel=1e-3)


def test_a_kink_may_be_touched():
    scene = cart("-k*cart.x + F*max(-cart.x - A, 0)")
    scene["parameters"]["A"] = 0.1
    assert sensitivities(read(scene), ["k"], "final(cart.x)").to["k"] == pytest.approx(
        sensitivities(read(cart("-k*cart.x")), ["k"], "final(cart.x)").to["k"], rel=1e-6
    )


@pytest.mark.parametrize("of", ["peak(cart.x)", "max(cart.x)", "min(cart.vx)"])
def test_an_extreme_at_several_instants_with_other_derivatives_is_refused(of):
    """A body at rest under a force that is zero."""
    scene = cart("a", parameters={**NUMBERS, "a": 0.0})
    with pytest.raises(SolverError, match="at 11 output times, first at t = 0 s, with different derivatives"):
        sensitivities(read(scene), ["a"], of)


def test_a_jump_without_a_breakpoint_is_refused():
    """A body falls through the anchor of its spring: the force turns round there, though no law has a breakpoint."""
    scene = cart("0", joints={}, gravity=[0, 0])
    scene["forces"]["spring"] = {
        "type": "spring_damper", "i": "cart", "j": {"body": "ground", "point": [0.35, -0.2]}, "stiffness": "k", "free_length": 0.1,
    }  # fmt: skip
    with pytest.raises(
        SolverError, match=r"accelerations are discontinuous at t = .* where no force declares a breakpoint"
    ):
        sensitivities(read(scene), ["k"], "final(cart.x)")


def two_sleds(of_a, of_b):
    """Two bodies that reach x = 0 at 0.2 s."""
    return {
        "parameters": {"A": 0.0, "B": 0.0, "v": 1.0, "F": 5.0},
        "bodies": {
            "a": {"mass": 1, "inertia": 1, "position": [-0.2, 0], "velocity": ["v", 0]},
            "b": {"mass": 2, "inertia": 1, "position": [-0.2, 1], "velocity": ["v", 0]},
        },
        "forces": {
            "fa": {"type": "force", "i": "a", "force": [of_a, 0]}, "fb": {"type": "force", "i": "b", "force": [of_b, 0]},
        },
        "run": {"duration": 0.5, "points": 6, "rtol": 1e-7},
    }  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("of_a", "of_b"),
    [
        ("branch(a.x - A, 0, 0, -F)", "branch(b.x - B, 0, 0, -3)"),
        ("branch(a.x - A, 0, 0, -F)", "branch(t - 0.2 - B, 0, 0, -3)"),
        ("branch(a.x - A, 0, 0, -F) + branch(b.x - B, 0, 0, -3)", "0"),
        ("branch(a.x - A, 0, 0, branch(b.x - B, 0, 0, -3))", "0"),
        ("-100*max(a.x - A, 0)*(1 + a.vx)", "branch(b.x - B, 0, 0, -3)"),
    ],
)
def test_events_at_one_instant_that_a_parameter_moves_apart_are_refused(of_a, of_b):
    scene = read(two_sleds(of_a, of_b))
    for to in ("A", "B"):
        with pytest.raises(SolverError, match=r"simultaneous events at t = 0\.2 s, which the parameters separate"):
            sensitivities(scene, to, "final(a.vx)")


@pytest.mark.long
def test_events_at_one_instant_that_move_together():
    """Both bodies are slowed from x = 0 on, at the same instant: v - F (0.5 - 0.2/v)/m."""
    scene = read(two_sleds("branch(a.x, 0, 0, -F)", "branch(b.x, 0, 0, -F)"))
    for body, mass in (("a", 1), ("b", 2)):
        found = sensitivities(scene, ["v", "F"], f"final({body}.vx)").to
        assert found == pytest.approx({"v": 1 - 5 * 0.2 / mass, "F": -0.3 / mass}, rel=1e-6, abs=1e-9)


@pytest.mark.long
def test_kinks_at_one_instant_may_move_apart():
    scene = two_sleds("-100*max(a.x - A, 0)*(1 + a.vx)", "-60*max(b.x - B, 0)")
    for of, to in (("final(a.vx)", "A"), ("final(b.vx)", "B"), ("final(b.x)", "v")):
        assert sensitivities(read(scene), [to], of).to[to] == pytest.approx(steep(scene, to, of), rel=1e-4)


def steep(found, name, of, h=1e-5):
    """By central differences about a value that may be zero."""
    value, (output,) = found["parameters"][name], outputs_of(of)
    below, above = (
        output.value(stiffmbs.run(read(found, **{name: value + shift}), rtol=1e-11, solver="bdf")) for shift in (-h, h)
    )
    return (above - below) / (2 * h)


DRIVEN = """
parameters: {a: 1.5, m: 1.3, I: 0.05}
gravity: [0, -9.81]
bodies:
  arm: {mass: 2, inertia: 0.1, position: [0.4, 0]}
  bob: {mass: m, inertia: I, position: [0.8, -0.35]}
joints:
  pin: {type: revolute, i: {body: arm, point: [-0.4, 0]}, j: ground}
  link: {type: revolute, i: {body: bob, point: [0, 0.35]}, j: arm}
  motor: {type: drive, joint: pin, velocity: "branch(t - 0.3, a, a, 2.5*a) rad/s"}
run: {duration: 0.6, rtol: 1e-8, points: 7}
"""


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(("name", "value"), [("a", 1.5), ("m", 1.3), ("I", 0.05)])
def test_a_drive_whose_velocity_jumps_pushes_the_other_bodies(name, value):
    """Velocities change by the smallest correction in the mass matrix, whose derivatives are part of the sensitivity."""
    found = sensitivities(stiffmbs.read_scene(DRIVEN), [name], "final(bob.angle)")
    h = 1e-4
    ends = [
        stiffmbs.run(stiffmbs.read_scene(DRIVEN, [(name, repr(value + shift))]), rtol=1e-11)["bob.angle"][-1]
        for shift in (-h, h)
    ]
    assert found.to[name] == pytest.approx((ends[1] - ends[0]) / (2 * h), rel=2e-5)


KINKS_OVER_A_STATE = """
tables: {{ramp: {{table: [[0, 0], [0.3, 1], [0.5, -1], [0.8, 2], [3, 0]], lines: true}}}}
bodies: {{a: {{mass: 1, inertia: 1, velocity: [{v}, 0]}}}}
joints: {{rail: {{type: prismatic, i: a, j: ground}}}}
states: {{z: {{rate: "a.x - z/5", start: -0.09}}, p: {{zero: "p - a.x - 0.1*a.vx", start: 0}}}}
forces: {{push: {{type: force, i: a, force: ["40*ramp(t + z)", 0]}}}}
run: {{duration: 0.5 s, points: 11}}
"""


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["bdf", "radau"])
def test_a_kink_over_a_state_ends_steps_on_its_own_side(solver):
    """The last step before a kink has the slope before it at all nodes, although the kink is located with an error."""

    def velocity(v):
        scene = stiffmbs.read_scene(KINKS_OVER_A_STATE.format(v=v))
        return stiffmbs.run(scene, solver="projected", scheme="dop853", rtol=1e-13)["a.vx"]

    h = 1e-4
    near, far = (velocity(0.7 + step) - velocity(0.7 - step) for step in (h, 2 * h))
    name = "bodies.a.velocity.0"
    found = stiffmbs.sensitivities(stiffmbs.read_scene(KINKS_OVER_A_STATE.format(v=0.7)), name, "a.vx", solver=solver)
    assert found.to[name] == pytest.approx((8 * near - far) / (12 * h), abs=1e-8)
