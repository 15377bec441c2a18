"""The section `states` of scenes: names, units, parts and faults."""

import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Model, State
from stiffmbs.errors import InputError

SCENE = """
name: lag
parameters: {k: 100 N/m, tau: 0.1 s}
variables: {stretch: "2*delayed"}
bodies: {cart: {mass: 1, inertia: 1, position: [0.1, 0]}}
states: {delayed: {rate: "(cart.x - delayed)/tau", start: 20 mm}}
joints: {rail: {type: prismatic, i: cart, j: ground}}
forces: {push: {type: force, i: cart, force: ["-k*delayed", 0]}}
requests: {pull: "k*stretch", rate: "delayed.rate"}
run: {duration: 0.1, points: 3}
"""


def changed(old, new):
    assert old in SCENE
    return SCENE.replace(old, new)


def test_a_state_stands_in_formulas_variables_and_requests():
    solution = stiffmbs.run(stiffmbs.read_scene(SCENE))
    assert solution["delayed"][0] == 0.02
    assert solution["push.fx"] == pytest.approx(-100 * solution["delayed"])
    assert solution["pull"] == pytest.approx(200 * solution["delayed"])
    assert solution["rate"] == pytest.approx(solution["delayed.rate"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("-k*delayed", "-k*delay", "found the unknown name 'delay'"),
        ("-k*delayed", "-k*delayed/tau", "found '-k\\*delayed/tau', which is in kg m s\\^-3, expected a force"),
        ("(cart.x - delayed)/tau", "(cart.x - delayed)/k", "states.delayed: rate: found .* in .*, expected m/s"),
        ("(cart.x - delayed)/tau", "(box.x - delayed)/tau", "states.delayed.rate: found the unknown body 'box'"),
        ("(cart.x - delayed)/tau", "(late - delayed)/tau", "states.delayed.rate: found the unknown name 'late'"),
        ("start: 20 mm", "begin: 20 mm", "found the unknown key 'begin', expected one of rate, start, scale"),
        ("start: 20 mm", "scale: 0 m", "scale: found 0.0, expected a number greater than zero"),
        ("states: {delayed", "states: {cart: {rate: 1}, delayed", "found a name that bodies.cart has too"),
        ("states: {delayed", "states: {N: {rate: 1}, delayed", "found the name of a unit"),
        ("states: {delayed", "states: {k: {rate: 1}, delayed", "states.k: found a name that parameters.k has too"),
    ],
)  # fmt: skip
def test_faults_are_told_in_a_sentence(old, new, message):
    with pytest.raises(InputError, match=message):
        stiffmbs.run(stiffmbs.read_scene(changed(old, new)))


def test_parts_have_states_of_their_own():
    text = """
parts:
  axle:
    parameters: {tau: 0.1 s}
    bodies: {wheel: {mass: 1, inertia: 1, position: [1, 0]}}
    states: {lag: {rate: "(wheel.x - lag)/tau", start: 0 m}}
    joints: {rail: {type: prismatic, i: wheel, j: ground}}
    forces: {push: {type: force, i: wheel, force: ["-1 N/m*lag", 0]}}
    requests: {twice: 2*lag}
use:
  front: {part: axle}
  rear: {part: axle, parameters: {tau: 0.2 s}}
forces: {pull: {type: force, i: rear.wheel, force: ["0 N", "0*front.lag*1 N/m"]}}
run: {duration: 0.2, points: 3, rtol: 1e-9}
"""
    scene = stiffmbs.read_scene(text)
    solution = stiffmbs.run(scene)
    assert solution["front.lag.rate"][0] == pytest.approx(10)
    assert solution["rear.lag.rate"][0] == pytest.approx(5)
    assert solution["front.twice"] == pytest.approx(2 * solution["front.lag"])
    assert solution["front.push.fx"] == pytest.approx(-solution["front.lag"])


def test_a_force_of_a_state_that_is_not_there_is_refused_when_it_is_added():
    model = Model()
    model.add("cart", Body(mass=1, inertia=1))
    push = AppliedForce(i="cart", force=("-3*lag", 0))
    with pytest.raises(InputError, match="found the unknown name 'lag'"):
        model.add("push", push)
    model.add("lag", State(rate="cart.vx - other", start="0 m"))
    model.add("push", push)
    with pytest.raises(InputError, match="found it in use"):
        model.remove("lag")
    with pytest.raises(InputError, match="found the unknown name 'other'"):
        model.data()
