"""A slider on a turning guide, whose line passes the guide's hinge: the nearer it does, the less is known of what follows."""

import pytest

import stiffmbs

NOTE = "passes a singular pose near t = 0."


def slider(miss: float) -> stiffmbs.Scene:
    """The slider moves along y = `miss` at 2 m/s, from 1 m before the guide's hinge in the origin on."""
    return stiffmbs.read_scene(f"""
        gravity: [0, 0]
        bodies:
          guide: {{mass: 1, inertia: 0.5, position: [0, 0], angle: 0}}
          slider: {{mass: 1, inertia: 0.2, position: [-1, {miss}], angle: 0, velocity: [2, 0]}}
        joints:
          hinge: {{type: revolute, i: guide, j: ground}}
          rail: {{type: prismatic, i: slider, j: guide}}
          line: {{type: equation, zero: slider.y - {miss}}}
        forces:
          push: {{type: torque, i: guide, torque: 1}}
    """)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_branch_that_rounding_chooses_is_told(solver):
    solution = stiffmbs.run(slider(1e-11), duration=1.0, points=200, solver=solver)
    assert any(NOTE in note and "hinge" in note and "slider at" in note for note in solution.notes)


@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_swing_that_is_resolved_is_not(solver):
    solution = stiffmbs.run(slider(0.05), duration=1.0, points=200, solver=solver, rtol=1e-8)
    assert solution.success and not any("singular pose near" in note for note in solution.notes)
