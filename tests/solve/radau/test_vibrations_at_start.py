"""First steps that are long for a vibration, whose error estimate is small at some phases by chance."""

import numpy as np
import pytest

import stiffmbs

OSCILLATOR = """
bodies: {{mass: {{mass: 1, inertia: 1, position: [{x:.17g}, 0], velocity: [{v:.17g}, 0]}}}}
joints: {{rail: {{type: prismatic, i: mass, j: ground}}}}
forces: {{spring: {{type: force, i: mass, force: ["-{omega}^2*mass.x", 0]}}}}
run: {{duration: 0.05, points: 51, solver: radau, stages: {stages}, rtol: {rtol}, atol: {rtol}}}
"""
OMEGA, RTOL, PHASES = 1000.0, 1e-6, 50


@pytest.mark.long
@pytest.mark.sampled(6)
@pytest.mark.parametrize("stages", [3, 5, 7, "auto"])
def test_a_vibration_is_resolved_whatever_its_phase_at_the_start(stages):
    """A vibration of 300 tolerances; a step of many radians would damp it."""
    speed = 300 * RTOL
    for phase in np.linspace(0.0, 2 * np.pi, PHASES, endpoint=False) + 0.01:
        x, v = speed / OMEGA * np.cos(phase), -speed * np.sin(phase)
        text = OSCILLATOR.format(x=x, v=v, omega=OMEGA, stages=stages, rtol=RTOL)
        solution = stiffmbs.run(stiffmbs.read_scene(text))
        exact = -speed * np.sin(OMEGA * solution.time + phase)
        np.testing.assert_allclose(solution["mass.vx"], exact, rtol=0, atol=5 * RTOL, err_msg=f"phase {phase}")
