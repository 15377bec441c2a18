"""Fitting and optimising: parameters of known models are found again, and optima are those of closed forms."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError, Range, SolverError, fit, optimise
from stiffmbs.studies.parameters import Gradients

SLED = """
parameters: {k: 100 N/m, c: 1 N s/m, x0: 0.1 m}
bodies: {sled: {mass: 2, inertia: 1, position: [x0, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: force, i: sled, force: ["-k*sled.x - c*sled.vx", 0]}
run: {duration: 2, rtol: 1e-8}
"""


def moved(t, k, c, m=2.0, x0=0.1):
    """A damped oscillation from rest."""
    d, w = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
    return x0 * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))


def noisy(seed, sigma=1e-3, k=130.0, c=2.5):
    t = np.sort(np.random.default_rng(0).uniform(0, 2, 60))  # no even spacing
    return {"time": t, "sled.x": moved(t, k, c) + np.random.default_rng(seed).normal(0, sigma, 60)}


PARAMETERS = {"k": Range(50, 500, log=True), "c": (0.1, 10)}


@pytest.mark.long
def test_stiffness_and_damping_are_found_again():
    t = np.linspace(0, 2, 40)
    found = fit(stiffmbs.read_scene(SLED), {"time": t, "sled.x": moved(t, 130.0, 2.5)}, PARAMETERS)
    assert found.success
    assert found.values["k"] == pytest.approx(130.0, rel=1e-5)
    assert found.values["c"] == pytest.approx(2.5, rel=1e-4)
    np.testing.assert_allclose(found.solution["sled.x"], moved(found.solution.time, 130.0, 2.5), atol=1e-6)


@pytest.mark.long
def test_standard_errors_are_those_of_linear_theory():
    """sigma^2 (J^T J)^-1 with J of the closed form, by central differences of it."""
    data = noisy(1)
    found = fit(stiffmbs.read_scene(SLED), data, PARAMETERS)
    k, c = found.values["k"], found.values["c"]
    t, h = data["time"], 1e-5
    J = np.column_stack([
        (moved(t, k * (1 + h), c) - moved(t, k * (1 - h), c)) / (2 * h * k),
        (moved(t, k, c * (1 + h)) - moved(t, k, c * (1 - h))) / (2 * h * c),
    ])  # fmt: skip
    off = moved(t, k, c) - data["sled.x"]
    covariance = np.linalg.inv(J.T @ J) * (off @ off) / (len(t) - 2)
    np.testing.assert_allclose(list(found.standard_errors.values()), np.sqrt(np.diag(covariance)), rtol=5e-3)
    assert found.correlation[0, 1] == pytest.approx(
        covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1]), abs=5e-3
    )
    assert found.residuals["sled.x"] == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-3)


@pytest.mark.long(60)
def test_intervals_hold_the_truth_in_95_of_100_data_sets(every):
    scene, held = stiffmbs.read_scene(SLED), []
    for seed in every(range(100), 5):
        found = fit(scene, noisy(seed), PARAMETERS)
        held += [
            low <= truth <= high for (low, high), truth in zip(found.intervals.values(), (130.0, 2.5), strict=True)
        ]
    assert 0.90 <= np.mean(held) <= 0.99


@pytest.mark.long
def test_data_come_from_files_and_gaps_are_left_out(tmp_path):
    data = noisy(2)
    expected = fit(stiffmbs.read_scene(SLED), {name: values[5:] for name, values in data.items()}, PARAMETERS)
    gaps = {**data, "sled.x": np.where(np.arange(60) < 5, np.nan, data["sled.x"])}
    table = np.column_stack([gaps["time"], gaps["sled.x"]])
    np.savetxt(tmp_path / "data.csv", table, delimiter=",", header="time (s),sled.x (m)", comments="", fmt="%.17g")
    found = fit(stiffmbs.read_scene(SLED), tmp_path / "data.csv", PARAMETERS)
    for name in PARAMETERS:
        assert found.values[name] == pytest.approx(expected.values[name], rel=1e-6)


@pytest.mark.long
def test_channels_of_other_noise_are_weighted_by_it():
    """A channel with a hundred times the noise must not spoil what a good one tells."""
    data = noisy(3)
    data["sled.vx"] = np.gradient(moved(data["time"], 130.0, 2.5), data["time"]) * 0 + np.random.default_rng(4).normal(
        0, 5, 60
    )
    alone = fit(stiffmbs.read_scene(SLED), {name: data[name] for name in ("time", "sled.x")}, PARAMETERS)
    both = fit(stiffmbs.read_scene(SLED), data, PARAMETERS)
    assert both.values["k"] == pytest.approx(alone.values["k"], rel=2e-3)


@pytest.mark.parametrize(
    ("sigma", "sentence"),
    [
        (0.01, "found 0.01, expected a number for each channel"),
        ({"sled.x": 0}, "found 0 for"),
        ({}, "found None for"),
        ({"sled.x": "a"}, "found 'a' for"),
        ({"sled.x": True}, "found True for"),
    ],
)
def test_noise_is_given_for_each_channel(sigma, sentence):
    with pytest.raises(InputError, match=sentence):
        fit(stiffmbs.read_scene(SLED), noisy(0), PARAMETERS, sigma=sigma)


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize(
    ("data", "parameters", "error", "sentence"),
    [
        ({"sled.x": [1, 2]}, PARAMETERS, InputError, "found no times"),
        ({"time": [0, 0], "sled.x": [1, 2]}, PARAMETERS, InputError, "times that do not increase"),
        ({"time": [0, 1]}, PARAMETERS, InputError, "found no channel except the time"),
        ({"time": [0, 1, 2], "sled.z": [1, 2, 3]}, PARAMETERS, InputError, "found no channel 'sled.z'"),
        ({"time": [0, 1], "sled.x": [1, 2]}, PARAMETERS, InputError, "expected more than the 2 parameters"),
        ({"time": [0, 1, 2], "sled.y": [0, 0, 1]}, PARAMETERS, InputError, "do not determine"),
        ({"time": [0, 1, 2], "sled.x": [1, 2]}, PARAMETERS, InputError, "expected one for each of 3 times"),
        ({"time": [0, 1, 2], "sled.x": [1, np.inf, 3]}, PARAMETERS, InputError, "found an infinite value of 'sled.x'"),
        ({"time": [0, 1, 2], "sled.x": [np.nan] * 3}, PARAMETERS, InputError, "no value of 'sled.x' that is a number"),
        ({"time": [0, 1, 2], "sled.x": [1, 2, 3]}, {}, InputError, "parameters: found none"),
        ({"time": [0, 1, 2], "sled.x": [1, 2, 3]}, {"k": 3}, InputError, "k: found 3, expected a range"),
        ({"time": [0, 1, 2], "sled.x": [1, 2, 3]}, {"k": (3, 1)}, InputError, "k: range: found 3 to 1"),
    ],
)
def test_what_cannot_be_fitted_is_refused(data, parameters, error, sentence):
    with pytest.raises(error, match=sentence):
        fit(stiffmbs.read_scene(SLED), data, parameters)


@pytest.mark.parametrize(
    ("text", "sentence"), [("", "found no times"), ("time,sled.x\n1,2\n1,3\n", "found times that do not")]
)
def test_a_file_that_cannot_be_fitted_is_named(tmp_path, text, sentence):
    (tmp_path / "empty.csv").write_text(text)
    with pytest.raises(InputError, match=rf"empty\.csv: {sentence}"):
        fit(stiffmbs.read_scene(SLED), tmp_path / "empty.csv", PARAMETERS)


@pytest.mark.long
def test_the_damping_of_least_mean_square_is_that_of_the_closed_form():
    """Over a long time the integral of x^2 is x0^2/2 (m/c + c/k), least at c = sqrt(m k)."""
    scene = stiffmbs.read_scene(SLED)
    found = optimise(scene, "integral((sled.x)^2)", {"c": (2, 60)}, start={"c": 40}, duration=10, points=4001)
    assert found.success and found.before > found.objective
    assert found.values["c"] == pytest.approx(np.sqrt(200.0), rel=1e-2)
    assert found.objective == pytest.approx(0.1**2 / 2 * 2 * np.sqrt(2 / 100), rel=1e-4)


def test_a_constraint_that_binds_is_met():
    """At the start the acceleration is k x0 / m; the overshoot of a damped oscillation falls with the damping."""
    limits = {"max(-sled.x)": (None, 0.02), "peak(sled.ax)": (4.0, None)}
    varied = {"c": (2, 20), "k": (60, 200)}
    found = optimise(stiffmbs.read_scene(SLED), "rms(sled.ax)", varied, limits, start={"c": 15}, points=2001)
    assert found.success
    assert found.constraints["max(-sled.x)"] <= 0.02 * (1 + 1e-5)
    assert found.constraints["peak(sled.ax)"] == pytest.approx(4.0, rel=1e-4)
    assert found.values["k"] == pytest.approx(80.0, rel=1e-3)


def test_what_cannot_be_optimised_is_refused():
    scene = stiffmbs.read_scene(SLED)
    with pytest.raises(InputError, match=r"output 'sled\.x': found a channel over time"):
        optimise(scene, "sled.x", {"c": (1, 2)})
    with pytest.raises(InputError, match="found no channel 'sled"):
        optimise(scene, "peak(sled.w)", {"c": (1, 2)})
    with pytest.raises(InputError, match="expected a value from 1 to 2"):
        optimise(scene, "peak(sled.x)", {"c": (1, 2)}, start={"c": 3})
    with pytest.raises(InputError, match="found no bound"):
        optimise(scene, "peak(sled.x)", {"c": (1, 2)}, {"rms(sled.x)": (None, None)})
    with pytest.raises(SolverError, match="start of the search"):
        optimise(
            stiffmbs.read_scene(
                SLED.replace("-c*sled.vx", "").replace("- c*sled.vx", "+ 1 N*sqrt(0.05 - t/1 s)/c*1 N s/m")
            ),
            "peak(sled.x)",
            {"c": (1, 2)},
        )


def test_the_gradient_of_a_final_value_leads_to_the_closed_form():
    """A stone is to be at 1 m after 0.5 s: v t - g t^2/2 = 1."""
    text = """
parameters: {v: 3}
gravity: [0, -10]
bodies: {stone: {mass: 2, inertia: 1, velocity: [0, v]}}
run: {duration: 0.5, rtol: 1e-8}
"""
    found = optimise(stiffmbs.read_scene(text), "(final(stone.y) - 1)^2", {"v": (1, 8)})
    assert found.values["v"] == pytest.approx((1 + 1.25) / 0.5, rel=1e-4)
    assert found.runs < 25


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("ranges", "sentence"),
    [
        ({"k": (20.0, 110.0)}, "'k' is at its upper bound, 110:"),
        ({"k": (150.0, 400.0), "c": (0.5, 5.0)}, "'k' is at its lower bound, 150:"),
        ({"k": Range(135.0, 200.0, log=True)}, "'k' is at its lower bound, 135:"),
        ({"k": (100.0, 200.0)}, ""),
    ],
)
def test_a_fit_that_ends_at_a_bound_says_so(ranges, sentence):
    found = fit(stiffmbs.read_scene(SLED), noisy(1), ranges)
    assert sentence in found.message
    assert bool(sentence) == ("bound" in found.message)


@pytest.mark.long
def test_a_fit_ends_where_steps_are_below_the_integration_error():
    """Further steps follow the integration error alone: the estimates are within a tenth of their standard errors."""
    data = noisy(3)
    noise = np.random.default_rng(4).normal(0, 0.05, len(data["time"]))
    data["sled.vx"] = np.gradient(moved(data["time"], 130.0, 2.5), data["time"]) + noise
    scene = stiffmbs.read_scene(SLED)
    precise, found = (fit(scene, data, PARAMETERS, rtol=rtol) for rtol in (1e-9, 1e-4))
    assert found.success and found.runs <= 15
    for name, error in precise.standard_errors.items():
        assert found.values[name] == pytest.approx(precise.values[name], abs=0.1 * error)
        assert found.standard_errors[name] == pytest.approx(error, rel=0.02)


@pytest.mark.long
def test_sensitivities_that_fail_are_not_tried_again(monkeypatch):
    tried = []
    monkeypatch.setattr(Gradients, "at", lambda _, point: refuse_derivatives(tried, point))
    found = fit(stiffmbs.read_scene(SLED), noisy(3), PARAMETERS)
    assert len(tried) == 1
    assert found.values["k"] == pytest.approx(130.0, rel=0.01)


def refuse_derivatives(tried, point):
    tried.append(point)
    raise SolverError("found no derivatives")
