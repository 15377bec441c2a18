"""The command ``stiffmbs realtime``."""

import json
import socket

import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main
from stiffmbs.errors import SolverError
from stiffmbs.real_time.recorded import RecordedSimulation


def invoke(*words):
    return CliRunner().invoke(main, ["realtime", *(str(word) for word in words)])


@pytest.fixture
def scene(examples):
    return examples / "cart_pendulum.yaml"


def test_the_report_has_times_and_differences(scene):
    result = invoke(scene, "--step", "1ms", "--duration", "50 ms", "--as-fast-as-possible")
    assert result.exit_code == 0, result.output
    for words in ("50 of 50 steps of 1 ms by extrapolated_euler, as fast as possible", "99.99 %", "longer than a step",
                  "largest differences from bdf"):  # fmt: skip
        assert words in result.stdout
    assert "behind the clock" not in result.stdout


def test_paced_steps_tell_how_many_were_late(scene):
    result = invoke(scene, "--step", "5ms", "--duration", "0.05", "-q")
    assert "behind the clock" in result.stdout
    assert not result.stderr


def test_the_json_has_the_same_numbers(scene):
    result = invoke(scene, "--step", "1ms", "--duration", "20ms", "--solver", "rk4", "--as-fast-as-possible", "--json")
    found = json.loads(result.stdout)
    assert (found["status"], found["solver"], found["steps"], found["step"]) == ("done", "rk4", 20, 1e-3)
    assert found["times"]["mean"] <= found["times"]["longest"] == found["times"]["99.99 %"]
    assert {"position", "force"} <= {one["kind"] for one in found["accuracy"]["differences"]}


def test_a_step_that_fails_is_one_sentence_and_keeps_the_report(scene, monkeypatch):
    own = RecordedSimulation.step

    def step(sim, dt):
        if sim.t > 0.0295:
            raise SolverError("the step at t = 0.03 s failed")
        own(sim, dt)

    monkeypatch.setattr(RecordedSimulation, "step", step)
    result = invoke(scene, "--step", "1ms", "--duration", "50 ms", "--as-fast-as-possible", "-q")
    assert result.exit_code == 1
    assert "30 of 50 steps" in result.stdout
    assert "the step at t = 0.03 s failed" in result.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--step", "0"], "run.step: found 0, expected a time greater than 0 s"),
        (["--step", "-1ms"], "run.step: found -1ms"),
        ([], "step: found none, expected the time step, such as step=1e-3 or --step 1ms"),
        (["--step", "1ms", "--channels", "cart.z"], "no channel 'cart.z'"),
        (["--step", "1ms", "--input", "G=1"], "G: found no such parameter"),
        (["--step", "1ms", "--input", "G"], "--input: found 'G', expected NAME=VALUE"),
        (["--step", "1ms", "--solver", "extrapolated"], "did you mean 'extrapolated_euler'?"),
        (["--step", "1ms", "--udp", "0.0.0.0:0"], "--network allows it"),
    ],
)
def test_invalid_options_are_one_sentence(scene, words, message):
    result = invoke(scene, *words)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_port_in_use_is_one_sentence(scene):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        result = invoke(scene, "--step", "1ms", "--udp", f"127.0.0.1:{other.getsockname()[1]}")
    assert result.exit_code == 2
    assert "the port is in use" in result.stderr
