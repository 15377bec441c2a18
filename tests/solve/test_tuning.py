"""Changed parameters of solvers hold for one run alone: in compiled code too, and in its cache."""

import copy
import pickle
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import tuning
from stiffmbs.analyses import job as job_module
from stiffmbs.analyses.job import prepare
from stiffmbs.commands.main import main
from stiffmbs.dynamics.native.layouts import DYNAMICS
from stiffmbs.equilibria.parameters import EQUILIBRIA
from stiffmbs.redundancy.parameters import REDUNDANCY
from tests.bench.problems.chain_in_space import chain_in_space

ROOT = Path(stiffmbs.__file__).parents[1]
EXAMPLE = str(ROOT / "examples" / "cart_pendulum.yaml")
TIGHT_STEPS = {"explicit_steps": {"safety": 0.5}}
TIGHT_NEWTON = {"newton": {"loosest": 0.003}}


def solved(**settings):
    """Return steps and last angle of a short run."""
    found = stiffmbs.run(EXAMPLE, duration=0.5, points=11, **settings)
    return found.solver["steps"], float(found["bar.angle"][-1])


@pytest.mark.parametrize("name", tuning.SUBSYSTEMS)
def test_each_subsystem_has_a_dataclass_of_numbers(name):
    assert is_dataclass(tuning.defaults_of(name))
    assert tuning.numbers_of(tuning.defaults_of(name))
    module, _, variable = tuning.SUBSYSTEMS[name].partition(":")
    registered = getattr(import_module(f"stiffmbs.{module}"), variable)
    assert copy.deepcopy(registered) is pickle.loads(pickle.dumps(registered)) is registered


def test_all_parameters_are_registered():
    """Except those of pictures and of readers of robots, which no run uses; parameters of studies do not belong to `run.tuning`."""
    made = {
        (str(path.relative_to(ROOT / "stiffmbs").with_suffix("")).replace("/", "."), variable)
        for path in (ROOT / "stiffmbs").glob("**/*.py")
        if not any(path.is_relative_to(ROOT / "stiffmbs" / room) for room in ("show", "robots"))
        for variable in re.findall(
            r"^([A-Z_]+) = (?:tuned\(\s*\"\w+\", )?\w+Parameters\(", path.read_text(), re.MULTILINE
        )
    }
    registered = {tuple(place.split(":")) for place in tuning.SUBSYSTEMS.values()}
    assert made <= registered


def test_the_page_names_all_subsystems():
    page = (ROOT / "docs" / "reference" / "tuning.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE) == [*tuning.SUBSYSTEMS]


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "settings, changes",
    [({"solver": "projected"}, TIGHT_STEPS), ({}, TIGHT_NEWTON), ({"solver": "bdf"}, {"error_test": {"margin": 0.01}})],
)
def test_changes_hold_for_their_run_alone(settings, changes):
    usual = solved(**settings)
    assert solved(**settings, tuning={name: {} for name in changes}) == usual
    changed = solved(**settings, tuning=changes)
    assert changed[0] != usual[0]
    assert abs(changed[1] - usual[1]) < 1e-4
    assert solved(**settings) == usual
    assert solved(**settings, tuning=changes) == changed


def test_runs_in_other_threads_keep_their_parameters():
    cases = [{}, TIGHT_STEPS] * 3
    one_by_one = [solved(solver="projected", tuning=case) for case in cases]
    with ThreadPoolExecutor(3) as threads:
        together = list(threads.map(lambda case: solved(solver="projected", tuning=case), cases))
    assert together == one_by_one
    assert len({steps for steps, _ in together}) == 2


def test_a_study_varies_a_parameter():
    path, values = "run.tuning.explicit_steps.safety", [0.5, 0.9]
    found = stiffmbs.sweep(
        EXAMPLE, {path: values}, outputs={"angle": "final(bar.angle)"}, solver="projected", duration=0.5
    )
    expected = [solved(solver="projected", tuning={"explicit_steps": {"safety": value}})[1] for value in values]
    np.testing.assert_allclose(np.ravel(found["angle"]), expected, rtol=1e-7)


@pytest.mark.parametrize(
    "changes, message",
    [
        (3, "found 3, expected a mapping of subsystems"),
        ({"newton": 3}, "found 3, expected a mapping of parameters of 'newton'"),
        ({"newtn": {}}, r"found the unknown subsystem 'newtn' \(did you mean 'newton'\?\), expected one of auto"),
        ({"newton": {"losest": 1}}, r"newton: found the unknown parameter 'losest' \(did you mean 'loosest'\?\)"),
        ({"newton": {"loosest": "x"}}, "newton.loosest: found the unknown name 'x'"),
        ({"newton": {"loosest": True}}, "newton.loosest: found yes or no"),
        ({"newton": {"loosest": [0.1]}}, "newton.loosest: found"),
        ({"newton": {"loosest": None}}, "newton.loosest: found nothing"),
        ({"newton": {"loosest": 2}}, r"newton.loosest: found 2, expected a number between 0 and 1 \(the default is 0.03\)"),
        ({"newton": {"loosest": float("nan")}}, "newton.loosest: found nan"),
        ({"newton": {"unknown": 0.5}}, "newton.unknown: found 0.5, expected a number greater than 1"),
        ({"newton": {"last": 1.5}}, "newton.last: found 1.5, expected an integer from 1 to 3000"),
        ({"loop": {"most_steps": 0}}, "loop.most_steps: found 0, expected an integer from 1"),
        ({"loop": {"most_steps": 1e12}}, "loop.most_steps: found 1000000000000.0, expected an integer"),
        ({"linear_solver": {"sparse": [0.1]}}, "linear_solver.sparse: found .*, expected a list of 3 numbers"),
        ({"presolve": {"at_rest": 1e-9}}, "presolve: found the removed parameter 'at_rest': all modes of flexible bodies are"),
        ({"error_test": {"predicted_residual": False}}, "error_test: found the unknown parameter 'predicted_residual'"),
    ],
)  # fmt: skip
def test_a_wrong_entry_is_refused(changes, message):
    with pytest.raises(stiffmbs.InputError, match=f"tuning: {message}"):
        stiffmbs.run(EXAMPLE, tuning=changes)


def test_a_check_uses_changed_parameters():
    """The last message names at most as many joints as the parameter allows."""
    joints = ", ".join(f"r{k}: {{type: revolute, i: a, j: ground}}" for k in range(9))
    scene = stiffmbs.read_scene(f"{{bodies: {{a: {{mass: 1, inertia: 1}}}}, joints: {{{joints}}}}}")
    assert "r4 and 4 more" in stiffmbs.check(scene).messages[-1]
    assert "all of r0 and 8 more" in stiffmbs.check(scene, tuning={"redundancy": {"most_names": 2}}).messages[-1]


def test_an_equilibrium_uses_changed_parameters():
    with pytest.raises(stiffmbs.SolverError):
        stiffmbs.equilibrium(EXAMPLE, tuning={"equilibria": {"most_moves": 1, "most_corrections": 1}})
    assert stiffmbs.equilibrium(EXAMPLE).imbalance < 1e-6


def test_modes_use_changed_parameters():
    with pytest.raises(stiffmbs.SolverError, match="has no mass"):
        stiffmbs.modes(EXAMPLE, tuning={"linear_analysis": {"singular": 1.01}})
    assert len(stiffmbs.modes(EXAMPLE).modes) == 2


def test_the_elimination_of_a_job_uses_changed_parameters():
    scene = chain_in_space(10)
    table = [
        prepare(scene, tuning=changes).dynamics.table for changes in ({}, {"elimination": {"worth_compiling": 10**7}})
    ]
    assert [each[list(DYNAMICS).index("eliminates")] for each in table] == [1, 0]


def test_a_start_after_a_parameter_change_uses_changed_parameters(monkeypatch):
    job = prepare(EXAMPLE, tuning={"equilibria": {"most_moves": 7}})
    monkeypatch.setattr(job_module, "_start", lambda *_: EQUILIBRIA.most_moves)
    assert job_module.start_of_job(job) == 7


def test_joints_that_hold_at_the_start_use_changed_parameters(monkeypatch):
    scene = stiffmbs.load_scene(EXAMPLE, [("at_start.push", "{type: drive, joint: hinge, velocity: 1}")])
    seen = []

    def examine(*arguments):
        seen.append(REDUNDANCY.most_names)
        return usual(*arguments)

    usual = job_module.examine
    monkeypatch.setattr(job_module, "examine", examine)
    prepare(scene, tuning={"redundancy": {"most_names": 2}})
    assert seen == [2, 2]


@pytest.mark.long
def test_a_run_notes_its_changed_parameters():
    found = stiffmbs.run(EXAMPLE, duration=0.1, tuning={"newton": {"loosest": 0.01, "last": 3}})
    assert "run.tuning changes parameters of solvers or checks: newton.loosest = 0.01 (default 0.03)" in found.notes
    assert not any("tuning" in note for note in stiffmbs.run(EXAMPLE, duration=0.1, tuning={"newton": {}}).notes)


def test_the_command_prints_the_parameters_of_the_run():
    call = ["run", EXAMPLE, "-vv", "--json", "--duration", "0.1", "--set", "run.tuning.newton.loosest=0.01"]
    found = CliRunner().invoke(main, call)
    assert found.exit_code == 0
    lines = dict(re.findall(r"^parameters (\w+): (.*)$", found.output, re.MULTILINE))
    assert [*lines] == [*tuning.SUBSYSTEMS]
    assert lines["newton"].startswith("loosest = 0.01 (default 0.03), negligible = 1e-06, ")
    assert "default" not in lines["radau"]
    names = {name for name in lines for field in fields(tuning.defaults_of(name)) if field.name in lines[name]}
    assert names == set(lines)


def test_the_command_refuses_an_unknown_parameter_with_status_2():
    found = CliRunner().invoke(main, ["run", EXAMPLE, "--set", "run.tuning.newton.losest=0.01"])
    assert found.exit_code == 2
    assert "did you mean 'loosest'?" in found.output
