"""Some seeds of the fuzzers whose trials take processes: FMUs in FMPy, and commands under injected faults."""

import pytest

from stiffmbs.studies.fmu.standalone import model
from stiffmbs.studies.simulation import Simulation
from tests.stress.case import Outcome
from tests.stress.fuzzers import fmu, injections

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

MANY = (pytest.mark.long, pytest.mark.sampled(5))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (6, 20, 21, 22))])
def test_fmus_move_as_runs_do(seed):
    pytest.importorskip("fmpy")
    verdict = fmu.trial(seed)
    assert verdict.outcome is not Outcome.WRONG, verdict


def test_an_fmu_that_ignores_its_inputs_is_found(monkeypatch):
    pytest.importorskip("fmpy")
    step = Simulation.step
    monkeypatch.setattr(fmu, "NATIVE", 0.0)
    monkeypatch.setattr(Simulation, "step", lambda self, length, inputs: step(self, length, {}))
    assert fmu.trial(1).outcome is Outcome.WRONG


@pytest.mark.parametrize("seed", [1, 8])
def test_an_fmu_without_python_that_ignores_its_inputs_is_found(monkeypatch, seed):
    """By model exchange, and by co-simulation."""
    pytest.importorskip("fmpy")
    if not fmu.has_compiler():
        pytest.skip("there is no C compiler")
    monkeypatch.setattr(fmu, "NATIVE", 1.0)
    assert fmu.trial(seed).outcome is Outcome.RIGHT
    monkeypatch.setattr(model, "_numbers", lambda job, solver, inputs: ())
    assert fmu.trial(seed).outcome is Outcome.WRONG


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", [5, *(pytest.param(seed, marks=MANY) for seed in (2, 8, *range(100, 112)))])
def test_commands_end_with_a_sentence_under_faults(seed):
    verdict = injections.trial(seed)
    assert verdict.outcome is not Outcome.WRONG, verdict


@pytest.mark.parametrize(
    ("status", "out", "err", "words"),
    [
        (1, b"", b"Traceback (most recent call last):\n  boom", "a traceback"),
        (-11, b"", b"", "exit status -11"),
        (3, b"", b"stiffmbs: x", "exit status 3"),
        (1, b"", b"", "without a sentence"),
        (2, b"", b"stiffmbs: a\nstiffmbs: b\nstiffmbs: c", "more than a sentence"),
        (0, b"{", b"", "no JSON"),
        (2, b"", b"stiffmbs: x: found a, expected b", ""),
    ],
)
def test_what_is_wrong_with_an_end_is_found(tmp_path, status, out, err, words):
    session = injections.Session(tmp_path, ["check", "in.yaml", "--json"], {})
    assert words in injections._fault(session, status, out, err, False)
    assert bool(words) == bool(injections._fault(session, status, out, err, False))


def test_half_a_file_is_found(tmp_path):
    session = injections.Session(tmp_path, ["report", "in.yaml", "-o", "out.html"], {})
    (tmp_path / "out.html").write_text("<html>")
    assert "half a file" in injections._fault(session, 1, b"", b"stiffmbs: x", False)
    (tmp_path / ".part-x").touch()
    assert "a part of a file is left" in injections._fault(session, 1, b"", b"stiffmbs: x", False)
