"""Transfer functions, linear systems and controllers as states: against SciPy and closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stiffmbs
from stiffmbs import PID, AppliedForce, Body, LinearSystem, Model, TransferFunction
from stiffmbs.errors import InputError

SCENE = """
parameters: {w: 20}
bodies: {cart: {mass: 2 kg, inertia: 1}}
states:
  motor: {pid: {input: cart.x, setpoint: 0.4 m, kp: 50, ki: 30, kd: 12, filter: 10 ms}}
  smooth: {numerator: [w^2], denominator: [1, 1.4*w, w^2], input: cart.vx}
  lead: {numerator: [2, 1], denominator: [0.1, 1], input: smooth}
  two: {a: [[-5, 1], [0, -2]], b: [[0], [1]], c: [[1, 0], [0, 1]], d: [[0], [3]], input: cart.x, outputs: [p, q]}
joints: {rail: {type: prismatic, i: cart, j: ground}}
forces: {push: {type: force, i: cart, force: [motor - 7 + 0*two.p, 0]}}
requests: {all: motor + lead + two.q}
run: {duration: 3, points: 31, rtol: 1e-10}
"""


def rates(t, y):
    """The same by hand."""
    x, v, integral, filtered, z, z2, lead, p, q = y
    error, w = 0.4 - x, 20
    force = 50 * error + 30 * integral + 12 * (error - filtered) / 0.01 - 7
    return [
        v, force / 2, error, (error - filtered) / 0.01, -1.4 * w * z + z2, w * w * (v - z), (z - lead) / 0.1, q - 5 * p, x - 2 * q,
    ]  # fmt: skip


@pytest.mark.long
def test_a_controlled_cart_with_filters_moves_as_scipy_says():
    solution = stiffmbs.run(stiffmbs.read_scene(SCENE))
    found = solve_ivp(rates, (0, 3), [0] * 9, t_eval=solution.time, rtol=1e-11, atol=1e-13, method="Radau")
    x, _, integral, filtered, z, _, lead, p, q = found.y
    assert solution["cart.x"] == pytest.approx(x, abs=1e-8)
    assert solution["smooth"] == pytest.approx(z, abs=1e-7)
    assert solution["lead"] == pytest.approx(20 * z - 19 * lead, abs=1e-6)
    assert solution["two.p"] == pytest.approx(p, abs=1e-8)
    assert solution["two.q"] == pytest.approx(q + 3 * x, abs=1e-8)
    assert solution["motor"] == pytest.approx(50 * (0.4 - x) + 30 * integral + 1200 * (0.4 - x - filtered), abs=1e-5)
    assert solution["all"] == pytest.approx(solution["motor"] + solution["lead"] + solution["two.q"], abs=1e-12)


@pytest.mark.long
def test_bdf_and_dop853_agree_and_so_does_the_scene_in_space():
    scene = stiffmbs.read_scene(SCENE)
    implicit, explicit = (stiffmbs.run(scene, solver=solver) for solver in ("bdf", "projected"))
    in_space = stiffmbs.run(stiffmbs.spatial.in_space(scene))
    for name in ("cart.x", "motor", "lead", "two.p"):
        assert implicit[name] == pytest.approx(explicit[name], abs=2e-5)
        assert in_space[name] == pytest.approx(implicit[name], abs=2e-5)


def test_a_filters_response_is_its_transfer_function():
    found = stiffmbs.transfer(stiffmbs.read_scene(SCENE), ["cart.fx"], ["cart.vx", "smooth", "lead"])
    frequencies = np.array([0.5, 2.0, 8.0])
    s, w = 2j * np.pi * frequencies, 20
    v, smooth, lead = found.response(frequencies)[:, :, 0].T
    assert smooth / v == pytest.approx(w**2 / (s**2 + 1.4 * w * s + w**2), rel=1e-7)
    assert lead / smooth == pytest.approx((2 * s + 1) / (0.1 * s + 1), rel=1e-7)


@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_a_step_response_is_that_of_scipy(order):
    from scipy.signal import lti, step

    rng = np.random.default_rng(order)
    denominator = np.poly(-rng.uniform(1, 5, order))
    numerator = rng.uniform(-1, 1, order + rng.integers(0, 2))
    model = Model("a body at rest")
    model.add("box", Body(mass=1, inertia=1))
    model.add("y", TransferFunction(numerator=numerator, denominator=denominator, input="1"))
    solution = stiffmbs.run(model, duration=2.0, points=21, rtol=1e-10)
    _, expected = step(lti(numerator, denominator), T=solution.time)
    assert solution["y"] == pytest.approx(expected, abs=1e-8)


def test_models_with_linear_systems_are_written_and_read_again():
    model = Model("written")
    model.add("cart", Body(mass=1, inertia=1))
    model.add("two", LinearSystem(a=[[-1]], b=[[1]], c=[[1], [2]], input="cart.x", outputs=("p", "q"), start=(0.5,)))
    model.add("control", PID(input="cart.vx", setpoint="0.1*t", kp=3))
    model.add("push", AppliedForce(i="cart", force=("two.p + two.q + control", 0)))
    again = stiffmbs.read_scene(model.to_scene())
    assert again.states == model.states
    settings = {"duration": 1.0, "points": 3}
    assert stiffmbs.run(again, **settings)["cart.x"] == pytest.approx(stiffmbs.run(model, **settings)["cart.x"])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("numerator: [2, 1]", "numerator: [2, 1, 1]", "lead: numerator: found the degree 2 above that of the denominator, 1"),
        ("denominator: [0.1, 1]", "denominator: [0, 0]", "lead: denominator: found zeros"),
        ("input: smooth", "input: lead", "found an algebraic loop \\(lead -> lead\\)"),
        ("b: [[0], [1]]", "b: [[0, 1]]", "two: b: found 1 rows of 2 numbers, expected 2 rows of 1"),
        ("outputs: [p, q]", "outputs: [p]", "two: outputs: found 1 names, expected 2"),
        (", filter: 10 ms", "", "motor: filter: found none with kd"),
        ("kp: 50,", "kp: 50, kq: 3,", "motor: found the unknown key 'kq'"),
        ("{numerator: [w^2], denominator: [1, 1.4*w, w^2], input: cart.vx}", "{input: 3}", "smooth: found none of the keys"),
    ],
)  # fmt: skip
def test_faults_are_told_in_a_sentence(old, new, message):
    assert old in SCENE
    with pytest.raises(InputError, match=message):
        stiffmbs.read_scene(SCENE.replace(old, new))
