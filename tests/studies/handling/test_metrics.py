"""Handling and ride metrics against closed forms, a bicycle model and the tables of ISO 2631-1."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import butter, lsim, sosfilt

import stiffmbs
from stiffmbs.studies.handling import braking, metrics, steady_state_cornering, steering_inputs, vibration
from stiffmbs.studies.handling.known import SEEN, Known
from stiffmbs.studies.handling.parameters import BrakingInATurn, ConstantRadius, SineWithDwell

MASS, YAW_INERTIA, TO_FRONT, TO_REAR, FRONT, REAR, SPEED = 1500.0, 2600.0, 1.2, 1.5, 9e4, 1.2e5, 22.0
WHEELBASE = TO_FRONT + TO_REAR
STANDING = SimpleNamespace(centre=(0.0, 0.0, 0.5), measured=(0.0, 0.0, 0.5), behind=lambda place: TO_REAR)
"""Car for what depends on the place of its centre of mass alone."""
GRADIENT = MASS / WHEELBASE * (TO_REAR / FRONT - TO_FRONT / REAR)


def bicycle():
    """State space of the linear bicycle model: steer angle to yaw rate and lateral acceleration."""
    a = np.array(
        [
            [-(FRONT + REAR) / (MASS * SPEED), -SPEED - (TO_FRONT * FRONT - TO_REAR * REAR) / (MASS * SPEED)],
            [
                -(TO_FRONT * FRONT - TO_REAR * REAR) / (YAW_INERTIA * SPEED),
                -(TO_FRONT**2 * FRONT + TO_REAR**2 * REAR) / (YAW_INERTIA * SPEED),
            ],
        ]
    )
    b = np.array([[FRONT / MASS], [TO_FRONT * FRONT / YAW_INERTIA]])
    return a, b, np.array([[0, 1], [a[0, 0], a[0, 1] + SPEED]]), np.array([[0], b[0]])


def answer(time, steer):
    yaw_rate, acceleration = lsim(bicycle(), steer, time)[1].T
    return yaw_rate, acceleration


def steady_gain():
    return SPEED / (WHEELBASE + GRADIENT * SPEED**2)


def test_the_understeer_gradient_of_both_methods():
    ay = np.linspace(0, 6, 60)
    at_constant_speed = ay * WHEELBASE / SPEED**2 + GRADIENT * ay + 2e-5 * ay**3
    at_constant_radius = WHEELBASE / 100 + GRADIENT * ay + 2e-5 * ay**3
    of = metrics.understeer_gradient
    assert of(ay, at_constant_speed * 16, 1 / 16, WHEELBASE, ay / SPEED**2) == pytest.approx(GRADIENT, rel=1e-6)
    assert of(ay, at_constant_radius * 16, 1 / 16) == pytest.approx(GRADIENT, rel=1e-6)
    with pytest.raises(stiffmbs.InputError, match=r"found 0 lateral accelerations up to 4 m/s\^2"):
        of(ay + 10, ay, 1.0)


def test_a_step_response_is_that_of_the_bicycle_model():
    time = np.arange(0, 6, 0.002)
    steer = 0.02 * np.clip((time - 1) / 0.1, 0, 1)
    yaw_rate, _ = answer(time, steer)
    found = metrics.step_response(time, steer, yaw_rate)
    assert found.gain == pytest.approx(steady_gain(), rel=1e-4)
    a = bicycle()[0]
    natural, damping = np.sqrt(np.linalg.det(a)), -np.trace(a) / 2 / np.sqrt(np.linalg.det(a))
    lead = YAW_INERTIA * 0 + MASS * SPEED * TO_FRONT / (WHEELBASE * REAR)  # zero of the yaw rate, s
    fine = np.arange(0, 4, 1e-4)
    damped = natural * np.sqrt(1 - damping**2)
    decay = np.exp(-damping * natural * fine)
    step = 1 - decay * (
        np.cos(damped * fine) + (damping * natural - lead * natural**2) / damped * np.sin(damped * fine)
    )
    assert found.overshoot == pytest.approx(step.max() - 1, rel=0.03)
    assert found.response_time == pytest.approx(fine[np.argmax(step >= 0.9)], rel=0.1), "the ramp lasts 0.1 s"
    assert metrics.step_response(time, -steer, -yaw_rate).overshoot == pytest.approx(found.overshoot)
    with pytest.raises(stiffmbs.InputError, match="no step"):
        metrics.step_response(time, 0 * steer, yaw_rate)


def inputs(time):
    """Return a sweep that ends at rest, one that is cut off, random steering, and a pulse."""
    sweep = 0.01 * np.sin(2 * np.pi * (0.2 * (time - 1) + 0.07 * (time - 1) ** 2 / 2)) * np.clip(time - 1, 0, 1)
    noise = np.random.default_rng(1).normal(size=len(time))
    band = sosfilt(butter(2, [0.1, 3], "band", fs=1 / (time[1] - time[0]), output="sos"), noise)
    pulse = 0.01 * np.exp(-(((time - 2) / 0.1) ** 2))
    return {"sweep": sweep * np.clip(41 - time, 0, 1), "cut off": sweep, "random": 0.1 * band, "pulse": pulse}


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("name", "lowest", "error"),
    [("sweep", 0.2, 2e-4), ("pulse", 0.2, 2e-4), ("cut off", 0.6, 1e-3), ("random", 0.2, 6e-3)],
)
def test_the_frequency_response_is_that_of_the_bicycle_model_within_its_error_bars(name, lowest, error):
    """Segments of 10 s had errors of 4 % and 2.5 deg with a coherence of 0.997."""
    fine = np.arange(0, 45, 0.001)
    steer = inputs(fine)[name]
    yaw_rate, _ = answer(fine, steer)
    found = metrics.frequency_response(fine[::10], steer[::10], yaw_rate[::10])
    a, b, c, d = bicycle()
    exact = np.array([(c @ np.linalg.solve(2j * np.pi * f * np.eye(2) - a, b) + d)[0, 0] for f in found.frequency])
    wrong = np.abs(found.gain * np.exp(1j * found.phase) / exact - 1)
    band = (found.frequency >= lowest) & (found.frequency <= 2.8)
    assert np.max(wrong[band]) < error
    assert np.max(found.error[band]) < 10 * error
    assert np.all(wrong[band] < 2 * found.error[band] + 5e-5), "twice the bar, and the error of linear interpolation"
    assert np.min(found.coherence[band]) > 0.999
    assert np.isnan(found.at(1e3)[0])
    with pytest.raises(stiffmbs.InputError, match="found a record of 20"):
        metrics.frequency_response(fine[:20000:10], steer[:20000:10], yaw_rate[:20000:10])


def test_sine_with_dwell_of_a_yaw_rate_that_decays():
    time = np.arange(0, 6, 0.001)
    begin, end = 1.0, 1.0 + 1 / 0.7 + 0.5
    steer = np.where(
        (time > begin) & (time < begin + 0.714), 1.0, np.where((time >= begin + 0.714) & (time < end), -1.0, 0.0)
    )
    yaw_rate = 0.5 * steer - np.where(time >= end, 0.5 * np.exp(-(time - end) / 0.5), 0.0)
    for sign in (1, -1):
        found = metrics.sine_with_dwell(time, sign * steer, sign * yaw_rate, sign * 2 * (time - begin), begin, end)
        assert found.ratio_1 == pytest.approx(np.exp(-2), rel=1e-2)
        assert found.ratio_1_75 == pytest.approx(np.exp(-3.5), rel=1e-2)
        assert found.displacement == pytest.approx(2 * 1.07)
        assert found.stable
    spun = metrics.sine_with_dwell(time, steer, yaw_rate + np.where(time > end, 1.0, 0.0), time, begin, end)
    assert not spun.stable, "it spins in the direction of the first steering"


def dwelling(test, size, ahead=1.0, decay_to_right=0.5):
    """Return a run whose yaw rate follows the steering and decays, with a displacement of 2 m/s^2 t^2."""
    time = np.arange(0, 6, 0.001)
    end, shape = (
        steering_inputs.dwell_end(test),
        np.select([time < 1, time < 1.714, time < 1.714 + 1.2], [0, 1, -1], 0.0),
    )
    left = size * np.sin(np.clip((time - 1) / 0.2, 0, 1) * np.pi / 2) * shape * (time < end)
    decay = decay_to_right if size * ahead < 0 else 0.5
    after = np.where(time >= end, np.exp(-(time - end) / decay), 0.0)
    yaw_rate = 0.5 * ahead * (np.sign(left) - np.sign(size) * after)
    return {
        "time": time, SEEN: left, "vehicle.yaw_rate": yaw_rate, "vehicle.y": 2 * np.sign(size) * ahead * np.maximum(time - 1, 0) ** 2,
    }  # fmt: skip


@pytest.mark.parametrize("angular", [True, False])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_verdict_does_not_depend_on_the_direction_in_which_a_joint_steers(direction, angular):
    """Both directions of first steering, a final run of 270 deg, and displacements from 5 deg of the steering wheel on."""
    test = SineWithDwell(factors=(1.5, 5.0))
    turn = 1.0 if angular else 2 * np.pi / test.turn  # wheel angle per unit of the joint
    ramp = {"vehicle.ay": np.array([0.0, 10.0]), SEEN: direction * np.array([0.0, 10.0]) * np.radians(8) / turn}
    known = Known(SimpleNamespace(wheelbase=2.5, angular=angular), direction * 0.3, 0.0, 1.8, ramp)
    unit = np.radians(8) * test.lateral_acceleration / turn
    sizes = steering_inputs.amplitudes(known, test)
    assert list(sizes) == ["1.5 A", "5 A", "270 deg"]
    assert list(sizes.values()) == pytest.approx(direction * np.array([1.5 * unit, 5 * unit, 1.5 * np.pi / turn]))
    manoeuvres = steering_inputs.dwell(known, test)
    peaks = [
        eval(one.steer, {"t": 1 + 0.25 / 0.7, "min": min, "max": max, "sin": np.sin, "pi": np.pi}) for one in manoeuvres
    ]
    assert peaks == pytest.approx([sign * size for size in sizes.values() for sign in (1, -1)])
    runs = [dwelling(test, peak, direction) for peak in peaks]
    found = steering_inputs.of_dwell(known, test, runs)
    for side in ("left", "right"):
        assert found[f"yaw rate ratio after 1 s, 5 A, {side}"][0] == pytest.approx(100 * np.exp(-2), rel=1e-2)
        delay = 0.2 * 2 / np.pi * np.arcsin(np.radians(5) / turn / (5 * unit))
        assert delay > 0.002
        displacement = 2 * ((delay + 1.07) ** 2 - delay**2)
        assert found[f"lateral displacement, 5 A, {side}"][0] == pytest.approx(displacement, rel=1e-4)
        assert f"lateral displacement, 1.5 A, {side}" not in found
    assert found["steering-wheel angle of A"][0] == pytest.approx(8 * test.lateral_acceleration)
    assert (found["stable (1 yes, 0 no)"][0], found["responsive (1 yes, 0 no)"][0]) == (1, 1)
    runs[3] = dwelling(test, peaks[3], direction, decay_to_right=3.0)
    assert steering_inputs.of_dwell(known, test, runs)["stable (1 yes, 0 no)"][0] == 0, "unstable to the right alone"
    slow = SineWithDwell(factors=(1.5, 5.0), displacement=2.5)
    assert steering_inputs.of_dwell(known, slow, runs)["responsive (1 yes, 0 no)"][0] == 0


def test_amplitudes_of_a_sine_with_dwell_end_at_300_deg():
    """The final run is that of 6.5 A if this is more than 270 deg, and no run exceeds 300 deg."""
    for degrees, names in ((30, ["1.5 A", "6.5 A", "270 deg"]), (45, ["1.5 A", "6.5 A"]), (60, ["1.5 A", "300 deg"])):
        test = SineWithDwell(factors=(1.5, 6.5), lateral_acceleration=1.0)
        ramp = {"vehicle.ay": np.array([0.0, 10.0]), SEEN: np.array([0.0, 10 * np.radians(degrees)])}
        known = Known(SimpleNamespace(wheelbase=2.5, angular=True), 0.3, 0.0, 1.8, ramp)
        assert list(steering_inputs.amplitudes(known, test)) == names


def test_a_ramp_is_quasi_steady_up_to_its_largest_lateral_acceleration():
    """The response lags by 0.3 s, which is no steering of a steady turn."""
    time = np.arange(0, 30, 0.05)
    ay = 0.4 * np.where(time < 20, time, 40 - time)
    run = {"time": time + 1, "vehicle.ay": ay, SEEN: 0.01 * (ay + 0.3 * 0.4)}
    found = steady_state_cornering.quasi_steady(run)
    assert found["time"][[0, -1]] == pytest.approx([1.75, 21], abs=0.051)
    assert found[SEEN] == pytest.approx(0.01 * found["vehicle.ay"], abs=1e-9)
    later = steady_state_cornering.quasi_steady({**run, "time": time + 1.3})
    assert steady_state_cornering.lag_of(later) == pytest.approx(0.3)


@pytest.mark.parametrize("direction", [1, -1])
def test_the_steering_for_a_lateral_acceleration_is_that_of_the_ramp(direction):
    """Below the first quasi-steady value, 0.3 m/s^2, it was the steering for that."""
    ay = np.arange(0.31, 8, 0.017)
    known = Known(None, 1.0, 0.0, 1.8, {"vehicle.ay": ay, SEEN: direction * 0.01 * ay})
    for wanted in (0.05, 0.31, 2.0, 7.9):
        assert known.steer_for(wanted) == pytest.approx(direction * 0.01 * wanted, rel=1e-9)
    with pytest.raises(stiffmbs.InputError, match=r"largest lateral acceleration of 7\.9"):
        known.steer_for(8.1)


def test_a_circle_counts_up_to_the_limit():
    """A car that slid off a circle of 30 m at 17 m/s had -207 mrad/(m/s^2) of understeer, and a lateral error of 22 m."""
    time = np.arange(0, 100, 0.05)
    speed = 5 + 0.1 * time
    ay = np.where(time < 80, speed**2 / 40, 2.0)
    run = {
        "time": time + 13.1, "vehicle.ay": ay, "vehicle.speed": speed, "vehicle.yaw_rate": ay / speed,
        "vehicle.sideslip": 1e-3 * ay, "vehicle.roll": 0.02 * ay, SEEN: np.where(time < 80, WHEELBASE / 40 + 3e-3 * ay, 0.5),
        "handling_driver.lateral_error": np.where(time < 80, 0.01, 20.0),
    }  # fmt: skip
    known, test = Known(SimpleNamespace(wheelbase=WHEELBASE), WHEELBASE, 0.0, 1.8, {}), ConstantRadius(radius=40.0)
    found = steady_state_cornering.of_constant_radius(known, test, [run])
    assert found["understeer gradient"][0] == pytest.approx(3, rel=1e-6)
    assert found["largest lateral error"][0] == 0.01
    short = {name: values[:0] for name, values in run.items()}
    with pytest.raises(stiffmbs.InputError, match="found 0 lateral accelerations"):
        steady_state_cornering.of_constant_radius(known, test, [short])


def test_a_circle_has_turns_for_its_whole_speed():
    """The path went straight on after three turns: 70 mrad/(m/s^2) of understeer for 2.8."""
    known = Known(STANDING, 1.0, 0.0, 1.8, {})
    for acceleration in (0.02, 0.1, 0.5):
        test = ConstantRadius(acceleration=acceleration)
        (one,) = steady_state_cornering.constant_radius(known, test)
        way = test.first * one.driver["accelerates"] + (test.last**2 - test.first**2) / (2 * acceleration) + test.last
        assert one.path["turns"] * 2 * np.pi * test.radius > way - one.path["entry"]


@pytest.mark.parametrize("radius", [5.0, 100.0])
def test_a_circle_does_not_end_before_braking(radius):
    """That of 5 m ended after three turns: the car braked straight ahead."""
    test = BrakingInATurn(radius=radius)
    (one,) = braking.braking_in_a_turn(Known(STANDING, 1.0, 0.0, 1.8, {}), test)
    assert one.path["turns"] * 2 * np.pi * radius >= one.speed * one.duration


def test_a_car_that_stands_has_no_sideslip():
    """A pedal of 14 kN stopped it within the 3 s: the directions of its last movements gave 178 deg."""
    test = BrakingInATurn(lateral_acceleration=4.0)
    begin = braking._turn(test)[1]
    time = np.arange(0, begin + 3, 0.01)
    speed = np.maximum(20 - 9 * np.maximum(time - begin, 0), 1e-6)
    run = {
        "time": time, "vehicle.speed": speed, "vehicle.yaw_rate": speed / 100, "vehicle.ay": speed**2 / 100,
        "vehicle.ax": np.where(time > begin, -9.0, 0.0), "vehicle.sideslip": np.where(speed > 1, 0.02, 3.1),
    }  # fmt: skip
    found = braking.of_braking_in_a_turn(Known(None, 1.0, 0.0, 1.8, {}), test, [run])
    assert found["largest sideslip"][0] == pytest.approx(np.degrees(0.02))
    assert found["yaw rate ratio 1 s after"][0] == pytest.approx(1)


def test_a_slope_at_zero_does_not_depend_on_how_far_a_car_turned():
    """Tyres saturate: the slope of atanh at zero is 1, by any part of it. A cubic polynomial has 1.03 with the longest."""
    for limit in (2.0, 3.0, 4.0):
        x = np.linspace(0.3, limit, 200)
        assert metrics.at_zero(x, 7 * np.arctanh(x / 7) + 0.2) == pytest.approx((0.2, 1.0), abs=2e-3)


@pytest.mark.parametrize("friction", [0.5, 1.0, 3.0])
def test_a_slope_at_zero_of_a_brush_tyre_does_not_depend_on_its_friction(friction):
    """Fiala: F = C a - C^2 a|a|/(3 mu N) + ...; a fit by odd powers alone had slopes up to 1.06."""
    most = friction * 9.81
    x = np.linspace(0.3, 0.95 * most, 400)
    slip = 3.0 * most * (1.0 - np.cbrt(1.0 - x / most))
    assert metrics.at_zero(x, slip) == pytest.approx((0.0, 1.0), abs=6e-3)


def test_braking_at_constant_deceleration():
    time = np.arange(0, 4.9, 0.001)
    speed = np.maximum(27 - 6 * time, 0)
    assert metrics.mean_deceleration(time, speed) == pytest.approx(6, rel=1e-3)
    with pytest.raises(stiffmbs.InputError, match="lowest speed"):
        metrics.mean_deceleration(time[:2000], speed[:2000])
    assert metrics.yaw_rate_ratio(time, speed / 100, speed, 1.0) == pytest.approx(1)


def test_a_rigid_vehicle_tips_at_its_static_stability_factor():
    track, height = 1.5, 0.6
    assert metrics.static_stability_factor(track, height) == pytest.approx(1.25)
    ay = np.linspace(0, 20, 2001)
    inner = np.maximum(MASS * 9.81 / 2 - MASS * ay * height / track, 0)[:, None] / 2 * np.ones(2)
    assert metrics.rollover_threshold(ay, inner) == pytest.approx(1.25 * 9.81, rel=1e-3)
    assert np.isnan(metrics.rollover_threshold(ay[:100], inner[:100]))


@pytest.mark.parametrize(
    ("name", "frequencies", "factors"),
    [
        ("Wk", (0.5, 1, 2, 4, 6.3, 8, 16, 31.5, 80), (418, 482, 531, 967, 1054, 1036, 768, 405, 132)),
        ("Wd", (0.5, 1, 2, 4, 6.3, 8, 16), (853, 1011, 890, 512, 323, 253, 125)),
    ],
)
def test_weightings_are_those_of_the_tables_of_iso_2631(name, frequencies, factors):
    step, seconds = 0.001, 40
    time = np.arange(0, seconds, step)
    for frequency, factor in zip(frequencies, factors, strict=True):
        vibrating = np.sqrt(2) * np.sin(2 * np.pi * round(frequency * seconds) / seconds * time)
        assert vibration.weighted_rms(vibrating, step, name) == pytest.approx(factor / 1000, rel=0.004)


@pytest.mark.long
def test_spectra_keep_the_power_and_transmissibility_is_that_of_a_mass_on_a_spring():
    generator, step = np.random.default_rng(1), 0.002
    time = np.arange(0, 200, step)
    source = generator.normal(size=len(time))
    frequency, density = vibration.power_spectrum(source, step)
    assert np.trapezoid(density, frequency) == pytest.approx(np.var(source), rel=0.02)
    w, zeta = 2 * np.pi * 3, 0.3
    moved = lsim(([2 * zeta * w, w**2], [1, 2 * zeta * w, w**2]), source, time)[1]
    frequency, found = vibration.transmissibility(source, moved, step)
    s = 2j * np.pi * np.array([1.0, 3.0, 6.0])
    exact = np.abs((2 * zeta * w * s + w**2) / (s**2 + 2 * zeta * w * s + w**2))
    assert np.interp([1.0, 3.0, 6.0], frequency, found) == pytest.approx(exact, rel=0.03)


def test_an_unknown_weighting_is_refused():
    with pytest.raises(stiffmbs.InputError, match="did you mean 'Wk'"):
        vibration.weighted(np.ones(9), 0.1, "WK")


def test_times_that_a_metric_lacks_are_named():
    """A run that ends early was continued at its last value, and unequal steps were taken for equal ones."""
    time = np.arange(0, 4, 0.01)
    steer = np.where((time > 1) & (time < 2), 1.0, np.where((time >= 2) & (time < 2.5), -1.0, 0.0))
    with pytest.raises(stiffmbs.InputError, match=r"found times from 0 to 3.99 s, expected values at 4.25 s"):
        metrics.sine_with_dwell(time, steer, steer, time, 1.0, 2.5)
    with pytest.raises(stiffmbs.InputError, match=r"expected values at 4.5 s"):
        metrics.yaw_rate_ratio(time, time, time, 3.5)
    with pytest.raises(stiffmbs.InputError, match=r"found time steps from .* expected equal ones"):
        metrics.frequency_response(time**1.1, steer, steer)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("seed", range(12))
def test_the_step_response_of_any_stable_car(seed):
    """Times, gain and overshoot of a bicycle model at random, against the samples of its exact response; to either side."""
    rng = np.random.default_rng(seed)
    mass, inertia, front, rear, c_front, c_rear, v = rng.uniform(
        (900, 1200, 1, 1.2, 6e4, 9e4, 12), (2500, 4000, 1.2, 1.6, 9e4, 1.6e5, 28)
    )
    lever = front * c_front - rear * c_rear
    a = [
        [-(c_front + c_rear) / (mass * v), -v - lever / (mass * v)],
        [-lever / (inertia * v), -(front**2 * c_front + rear**2 * c_rear) / (inertia * v)],
    ]
    b, time = [[c_front / mass], [front * c_front / inertia]], np.arange(0, 12, 0.001)
    steer = (-1) ** seed * 0.02 * np.clip((time - 1) / 0.15, 0, 1)
    yaw_rate = lsim((a, b, [[0, 1]], [[0]]), steer, time)[1]
    gain = v / (front + rear + mass / (front + rear) * (rear / c_front - front / c_rear) * v**2)
    part, begun = yaw_rate / (gain * steer[-1]), time[np.argmax(np.abs(steer) >= 0.01)]
    found = metrics.step_response(time, steer, yaw_rate)
    assert found.gain == pytest.approx(gain, rel=1e-4)
    assert found.response_time == pytest.approx(time[np.argmax(part >= 0.9)] - begun, abs=2e-3)
    assert found.overshoot == pytest.approx(part.max() - 1, abs=2e-4)
    if part.max() > 1.01:
        assert found.peak_time == pytest.approx(time[np.argmax(part)] - begun, abs=2e-3)


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if k else ()) for k, name in enumerate(vibration.WEIGHTINGS)]
)
def test_weightings_are_the_analogue_filters_of_iso_2631_in_the_time_domain(name):
    """A random vibration through the transfer functions of its annex A, integrated over time."""
    f3, f4, f5, f6 = {"Wk": (12.5, 12.5, 2.37, 3.35), "Wd": (2, 2, 0, 0), "Wc": (8, 8, 0, 0), "We": (1, 1, 0, 0), "Wj": (0, 0, 3.75, 5.32)}[name]  # fmt: skip
    w, step = lambda f: 2 * np.pi * f, 5e-4
    second = lambda f, q: [1 / w(f) ** 2, 1 / (q * w(f)), 1]  # noqa: E731
    up = np.array([1 / w(0.4) ** 2, 0, 0])
    down = np.polymul(second(0.4, np.sqrt(0.5)), second(100, np.sqrt(0.5)))
    if f3:
        up, down = np.polymul(up, [1 / w(f3), 1]), np.polymul(down, second(f4, 0.63))
    if f5:
        up, down = np.polymul(up, second(f5, 0.91)) * (f5 / f6) ** 2, np.polymul(down, second(f6, 0.91))
    time, noise = np.arange(0, 60, step), np.random.default_rng(1).normal(size=120000)
    source = sosfilt(butter(4, [1, 60], "band", fs=1 / step, output="sos"), noise)
    expected = np.sqrt(np.mean(lsim((up, down), source, time)[1] ** 2))
    assert vibration.weighted_rms(source, step, name) == pytest.approx(expected, rel=5e-3)
