"""The choice of solver by the spectrum of the scene, and the spectrum itself."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import Body, Bushing, Model, Prismatic, SpringDamper
from stiffmbs.show.run import prepare
from stiffmbs.solve.spectrum import spectrum


@pytest.mark.parametrize(
    ("name", "changes", "solver"),
    [
        ("cart_pendulum", (), "projected"),
        ("four_bars", (), "projected"),
        ("half_car", (("k_b", "1e5"),), "projected"),
        ("half_car", (("k_b", "1e9"),), "bdf"),
        ("bouncing_ball", (), "bdf"),
    ],
)
def test_stiff_scenes_and_scenes_with_contacts_go_to_bdf(examples, name, changes, solver):
    scene = stiffmbs.load_scene(examples / f"{name}.yaml", list(changes))
    solution = stiffmbs.run(scene, solver="auto", duration=0.2)
    assert solution.solver["name"] == solver
    assert any(note.startswith(f"auto chose {solver}") for note in solution.notes)


def test_auto_gives_the_motion_of_bdf(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    chosen, implicit = (stiffmbs.run(scene, solver=solver, rtol=1e-8) for solver in ("auto", "bdf"))
    np.testing.assert_allclose(chosen["cart.x"], implicit["cart.x"], atol=1e-7)


def test_spectrum_of_a_damped_oscillator():
    """m s'' + c s' + k s = 0 on a rail: roots -c/2m +- i sqrt(k/m - (c/2m)^2)."""
    model = Model()
    model.add("sled", Body(mass=2, inertia=1))
    model.add("rail", Prismatic(i="sled", j="ground"))
    far = stiffmbs.Marker(body="ground", point=(-1, 0))
    model.add("spring", SpringDamper(i="sled", j=far, stiffness=50, damping=4, free_length=1))
    found = spectrum(prepare(model).mechanics, 0.0)
    np.testing.assert_allclose(np.sort(found.eigenvalues.imag), [-np.sqrt(24), np.sqrt(24)])
    np.testing.assert_allclose(found.eigenvalues.real, -1)
    assert found.fastest == pytest.approx(5)
    assert found.damping == pytest.approx(0.2)


def test_spectrum_of_a_pendulum_comes_from_its_multipliers():
    """The stiffness of a hanging bar is that of its pin's force: omega^2 = 3 g / 2 L."""
    model = Model(gravity=(0, -9.81))
    bar = model.add("bar", Body(mass=1.2, inertia=0.036, position=(0, -0.3), angle=-np.pi / 2))
    model.add("pin", stiffmbs.Revolute(i=bar.at(-0.3, 0), j="ground"))
    found = spectrum(prepare(model).mechanics, 0.0)
    assert found.fastest == pytest.approx(np.sqrt(1.5 * 9.81 / 0.6))


def test_rigid_motions_do_not_count_as_slow_ones():
    model = Model()
    for name, x in (("a", 0.0), ("b", 1.0)):
        model.add(name, Body(mass=1, inertia=1, position=(x, 0)))
    model.add("bush", Bushing(i="a", j=stiffmbs.Marker(body="b", point=(-1, 0)), stiffness=(1e6, 1e6, 1e6)))
    found = spectrum(prepare(model).mechanics, 0.0)
    assert found.slowest > 100
