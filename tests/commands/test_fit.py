"""The commands ``stiffmbs fit`` and ``stiffmbs optimise``."""

import json

import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main


def called(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


@pytest.mark.long
def test_a_spring_is_fitted_to_a_file_of_results(examples, tmp_path):
    scene, data = examples / "cart_pendulum.yaml", tmp_path / "data.csv"
    true = stiffmbs.run(
        stiffmbs.load_scene(scene, [("forces.spring.stiffness", "310")]), duration=1, points=51, rtol=1e-9
    )
    data.write_text("time,cart.x\n" + "".join(f"{t},{x}\n" for t, x in zip(true.time, true["cart.x"], strict=True)))
    given = (
        "fit",
        scene,
        "--data",
        data,
        "--parameter",
        "forces.spring.stiffness=200:400",
        "--start",
        "forces.spring.stiffness=250",
    )
    found = json.loads(called(*given, "--rtol", "1e-8", "--json").output)
    assert found["status"] == "done"
    assert found["parameters"]["forces.spring.stiffness"]["value"] == pytest.approx(310, rel=1e-5)
    text = called(*given, "--rtol", "1e-8")
    assert text.exit_code == 0 and "forces.spring.stiffness = 310, 95 % confidence interval" in text.output


def test_the_least_length_that_keeps_a_force_is_found(examples):
    scene = examples / "cart_pendulum.yaml"
    given = (
        "optimise",
        scene,
        "--minimise",
        "peak(cart.x)",
        "--parameter",
        "forces.spring.stiffness=200:400",
        "--duration",
        "0.5",
    )
    found = json.loads(called(*given, "--keep", "peak(spring.fx) <= 5 N", "--json").output)
    assert found["objective"] <= found["before"]
    assert found["constraints"]["peak(spring.fx)"] <= 5 * (1 + 1e-5)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (("--parameter", "L=1,2"), "found no range"),
        (("--parameter", "L=0.5:0.7", "--keep", "peak(cart.x)"), "--keep peak(cart.x): found no bound"),
        (("--parameter", "L=0.5:0.7", "--start", "L"), "--start: found 'L', expected NAME=VALUE"),
        (("--parameter", "L=0.5:0.7:0.1:1"), "--parameter L=0.5:0.7:0.1:1: found 4 numbers"),
    ],
)
def test_wrong_input_is_told_in_one_sentence(examples, given, sentence):
    result = called("optimise", examples / "cart_pendulum.yaml", "--minimise", "peak(cart.x)", *given)
    assert result.exit_code == 2
    assert sentence in result.output and "Traceback" not in result.output
