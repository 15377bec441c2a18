"""Solvers compared over a parameter."""

import pytest

import stiffmbs

SPRING = """
parameters: {{k: {k}}}
bodies: {{block: {{mass: 1, inertia: 1, position: [0.1, 0]}}}}
joints: {{rail: {{type: prismatic, i: block, j: ground}}}}
forces:
  spring: {{type: spring_damper, i: block, j: {{body: ground, point: [-1, 0]}}, stiffness: k, damping: 0.1*sqrt(k), free_length: 1}}
run: {{duration: 1, points: 51}}
"""
FAST = {"repeats": 1, "tolerances": (1e-3, 1e-4, 1e-5, 1e-6)}


def spring(k):
    return stiffmbs.read_scene(SPRING.format(k=k))


def test_a_row_for_each_value_and_solver():
    found = stiffmbs.compare_over(spring, "k", [100.0, 10.0], error=1e-5, solvers=("bdf", "dop853"), **FAST)
    content = found.as_dict("spring.yaml")
    assert [(row["solver"], row["setting"]) for row in content["rows"]] == [
        ("bdf", "k=10"), ("dop853", "k=10"), ("bdf", "k=100"), ("dop853", "k=100"),
    ]  # fmt: skip
    for row in content["rows"]:
        assert row.keys() == {"solver", "setting", "error", "seconds", "steps"}
        assert row["error"] == 1e-5
        assert row["seconds"] > 0
        assert row["steps"] > 1
    assert content["over"] == {"parameter": "k", "values": [10.0, 100.0], "error": 1e-5}
    assert "at an error of 1e-05 m or rad" in found.conclusion
    assert all(row["k"] in (10.0, 100.0) for row in content["measured"])


def test_steps_at_an_error_lie_between_those_of_the_rows_about_it():
    found = stiffmbs.compare_over(spring, "k", [100.0], error=1e-5, solvers=("bdf",), **FAST)
    (one,) = found.values
    steps = [row.steps for row in one.rows]
    assert min(steps) < one.at.steps["bdf"] < max(steps)


@pytest.mark.long
def test_a_value_without_reference_is_told_and_the_others_are_measured(examples):
    """A double pendulum from rest: soon a chaotic motion, unless there is nearly no gravity."""

    def pendulum(g):
        return stiffmbs.load_scene(
            examples / "chain.yaml",
            [("N", "2"), ("gravity", f"[0, {-g}]"), ("run.duration", "12"), ("run.output", "0.02")],
        )

    found = stiffmbs.compare_over(pendulum, "g", [1e-3, 9.81], error=1e-5, solvers=("dop853",), **FAST)
    calm, wild = found.values
    assert calm.at is not None
    assert wild.at is None
    assert "no reference" in wild.message
    row = found.as_dict("")["rows"][1]
    assert row["seconds"] is None
    assert "no reference" in row["message"]
    assert "g = 9.81: no reference" in str(found)


@pytest.mark.long
def test_no_value_with_a_reference_is_refused(examples):
    with pytest.raises(stiffmbs.SolverError, match="no reference"):
        stiffmbs.compare_over(
            lambda n: stiffmbs.load_scene(
                examples / "chain.yaml", [("N", f"{n:.0f}"), ("run.duration", "12"), ("run.output", "0.02")]
            ),
            "N",
            [2.0],
            **FAST,
        )


def test_an_error_that_is_better_than_the_reference_is_not_measured():
    with pytest.raises(stiffmbs.SolverError, match="the reference has an accuracy of"):
        stiffmbs.compare_over(spring, "k", [10.0], error=1e-14, solvers=("dop853",), **FAST)


def test_an_interruption_keeps_the_values_before_it():
    def tell(line):
        if line.startswith("k = 100"):
            raise KeyboardInterrupt

    found = stiffmbs.compare_over(spring, "k", [10.0, 100.0], error=1e-5, solvers=("dop853",), tell=tell, **FAST)
    assert found.interrupted
    assert [one.value for one in found.values] == [10.0]


def test_times_are_compared_at_an_error_of_the_measure():
    found = stiffmbs.compare_over(spring, "k", [100.0], error=1e-3, solvers=("dop853",), measure="forces", **FAST)
    assert "at an error of 0.001 N or N m in forces" in str(found)


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        ([], {}, "k: found no value,"),
        ([1.0], {"error": 0.0}, "error: found 0"),
        ([1.0], {"measure": "forces"}, "error: found none, expected one in N or N m"),
        ([1.0], {"solvers": ("x",)}, "found 'x'"),
    ],
)
def test_wrong_options_are_refused(values, options, message):
    with pytest.raises(stiffmbs.InputError, match=message):
        stiffmbs.compare_over(spring, "k", values, **options)
