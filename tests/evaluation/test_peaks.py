"""Peaks between output times, by closed forms."""

import numpy as np
import pytest

import stiffmbs

from ..conftest import EXAMPLES

OSCILLATOR = """
dimensions: 2
gravity: [0, 0]
bodies: {{b: {{mass: 2, inertia: 1, position: [{x}, 0], velocity: [{v}, 0]}}}}
joints: {{rail: {{type: prismatic, i: b, j: ground}}}}
forces: {{s: {{type: line_force, i: b, j: {{body: ground, point: [-9, 0]}}, force: "-{k}*dx(b)"}}}}
requests: {{deflection: dx(b)}}
run: {{duration: 3 s, points: {points}}}
"""


@pytest.mark.parametrize("solver", ["bdf", "radau", "projected", "auto"])
@pytest.mark.parametrize("points", [2, 7, 100])
def test_the_amplitude_of_an_oscillator_does_not_depend_on_output_times(solver, points):
    x, v, k = 0.03, 0.7, 800.0
    rate = np.sqrt(k / 2.0)
    amplitude = np.hypot(x, v / rate)
    scene = stiffmbs.read_scene(OSCILLATOR.format(x=x, v=v, k=k, points=points))
    found = stiffmbs.peaks(scene, solver=solver, rtol=1e-8)["deflection"]
    assert found.greatest == pytest.approx(amplitude, rel=2e-6) and found.least == pytest.approx(-amplitude, rel=2e-6)
    phase = np.arctan2(v / rate, x)
    turns = (rate * np.array([found.t_greatest, found.t_least]) - phase - [0.0, np.pi]) / (2.0 * np.pi)
    assert turns == pytest.approx(np.round(turns), abs=2e-3)


def test_a_narrow_blow_is_found():
    text = """
bodies: {b: {mass: 1, inertia: 0.1}}
forces: {f: {type: force, i: b, force: ["exp(-((t - 0.513)/1e-3)^2)", 0]}}
run: {duration: 1, output: 0.05}
"""
    found = stiffmbs.peaks(stiffmbs.read_scene(text), ["f.fx"])["f.fx"]
    assert found.greatest == pytest.approx(1.0, abs=1e-5) and found.t_greatest == pytest.approx(0.513, abs=1e-5)


def test_the_ends_of_a_run_are_peaks_too():
    found = stiffmbs.peaks(EXAMPLES / "bar_pendulum.yaml", ["bar.y"], duration=0.1)["bar.y"]
    solution = stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1)
    assert (found.greatest, found.least) == (solution["bar.y"][0], solution["bar.y"][-1])


def test_a_request_without_values_has_no_peak_and_hinders_no_other_one():
    text = """
bodies: {b: {mass: 1, inertia: 1, velocity: [1, 0]}}
requests: {never: sqrt(-1 - b.x), later: sqrt(b.x - 0.5)}
run: {duration: 1, points: 11}
"""
    found = stiffmbs.peaks(stiffmbs.read_scene(text))
    assert np.isnan([found["never"].least, found["never"].greatest]).all()
    assert found["later"].greatest == pytest.approx(np.sqrt(0.5)) and found["later"].t_greatest == 1.0


def test_one_channel_may_be_given_by_its_name():
    pendulum = EXAMPLES / "bar_pendulum.yaml"
    assert stiffmbs.peaks(pendulum, "bar.y", duration=0.1) == stiffmbs.peaks(pendulum, ["bar.y"], duration=0.1)


def test_what_is_missing_is_named():
    with pytest.raises(stiffmbs.InputError, match="no channels and no requests"):
        stiffmbs.peaks(EXAMPLES / "simple_pendulum.yaml", duration=0.1)
    with pytest.raises(stiffmbs.InputError, match=r"hinge\.fq"):
        stiffmbs.peaks(EXAMPLES / "bar_pendulum.yaml", ["hinge.fq"], duration=0.1)
