"""Cases of a study: their rows equal those of runs of the whole scenes."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.studies.case_solver import CaseSolver
from stiffmbs.studies.sweep import study_of

BLOCK = """
parameters: {k: 100.0 N/m, ratio: 0.1, c: 2*ratio*sqrt(k*2 kg), mu: 0.3, far: 0.4 m}
bodies: {block: {mass: 2, inertia: 1, position: [0.1, 0.3], velocity: [0.2, 0]}}
forces:
  spring: {type: spring_damper, i: block, j: ground, stiffness: k, damping: c, free_length: far}
  bushing: {type: bushing, i: block, j: ground, stiffness: [k, 2*k, 3], damping: [c, c, 1]}
  coupled: {type: bushing, i: block, j: ground, stiffness: [[5, 1, 0], [1, 5, 0], [0, 0, 3]], damping: [1, 1, 1]}
  floor: {type: contact, i: block, j: ground, radius: 0.2, stiffness: 10*k, dissipation: 0.1, friction: 0.3}
  push: {type: force, i: block, force: [0, "-3 - t"]}
run: {duration: 0.2, points: 5, rtol: 1e-6}
"""
OUTPUTS = ["final(block.x)", "final(block.y)", "peak(spring.fy)", "block.angle"]


def solver_of(varied, text=BLOCK):
    study = study_of(stiffmbs.read_scene(text), varied, None, 0, OUTPUTS, {})
    return CaseSolver(study.task), [*study.cases]


@pytest.mark.parametrize(
    "varied",
    [
        {"k": [100.0, 250.0, 100.0, 33.0], "ratio": [0.1, 0.0]},
        {"forces.bushing.stiffness": [[10, 20, 3], [0, 20, 4], [10, 20, 3]]},
        {"forces.coupled.stiffness": [[[5, e, 0], [e, 5, 0], [0, 0, 3]] for e in (1, 0.5, 0)]},
        {"forces.spring.free_length": [0.1, 0.3], "far": [0.2, 0.3]},
        {"forces.push.force": [[0, 1.0], [2.0, 3.0]]},
        {"forces.floor.stiffness": [1e3, 1e4]},
    ],
)
def test_rows_are_those_of_scenes_read_as_a_whole(varied, tmp_path):
    solver, cases = solver_of(varied)
    (file := tmp_path / "block.yaml").write_text(BLOCK)
    for k, values in enumerate(cases):
        scene = stiffmbs.load_scene(file, list(zip(varied, map(str, values), strict=True)))
        expected, row = stiffmbs.run(scene), solver.row(k, values)
        assert row.status == "done"
        for found, output in zip(row.values, OUTPUTS, strict=True):
            name = output.removeprefix("final(").removeprefix("peak(").removesuffix(")")
            series = expected[name]
            whole = np.max(np.abs(series)) if output.startswith("peak") else series
            np.testing.assert_array_equal(found, whole[-1] if output.startswith("final") else whole)


@pytest.mark.parametrize(
    ("varied", "sentence"),
    [
        ({"forces.floor.stiffness": [100.0, -1.0]}, "greater than 0"),
        ({"k": [100.0, -1.0]}, "negative number"),
        ({"k": [100.0, float("nan")]}, "finite"),
        ({"forces.coupled.stiffness": [[[5, e, 0], [1, 5, 0], [0, 0, 3]] for e in (1, 2)]}, "symmetric"),
        ({"forces.bushing.stiffness": [[1, 2, 3], [1, 2]]}, "expected 3"),
    ],
)
def test_what_a_scene_refuses_is_refused_in_its_words(varied, sentence):
    solver, (right, wrong) = solver_of(varied)
    assert solver.row(0, right).status == "done"
    row = solver.row(1, wrong)
    with pytest.raises(stiffmbs.InputError, match=sentence):
        solver.scene(wrong)
    assert row.status == "error" and sentence in row.message
    assert solver.row(0, right).values[:3] == solver_of(varied)[0].row(0, right).values[:3]


def test_a_case_leaves_nothing_behind_for_the_next():
    solver, _ = solver_of({"k": [100.0, 400.0]})
    first = solver.row(0, (100.0,)).values[:3]
    other = solver.row(1, (400.0,)).values[:3]
    job = solver.job(solver.scene((100.0,)))
    read = stiffmbs.analyses.run.solved(job)
    assert read["block.x"][-1] == first[0] != other[0]
