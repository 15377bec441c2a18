"""Responses to steering: step and sweep, ISO 7401, and sine with dwell, ISO 19365."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..targets import YES_OR_NO
from .car import Manoeuvre
from .known import SEEN, Known, Metrics, Run
from .metrics import STABLE, FrequencyResponse, first_time, frequency_response, sine_with_dwell, step_response
from .parameters import FrequencySweep, SineWithDwell, StepSteer

STEER_BEGIN = 1.0
SIDES = {"left": 1.0, "right": -1.0}
"""Direction of the first steering, and its sign."""
BEGUN = np.radians(5)
"""Angle of the steering wheel at which a sine with dwell begins, rad. ISO 19365."""
LAST = 6.5
"""Amplitude of the last run over the unit A. ISO 19365."""
RESPONSIVE = 5.0
"""Amplitude from which on the displacement counts, over the unit A. ISO 19365."""
BAR_OF = ", error bar"
"""End of the name of the error bar of a metric."""
SETTLING = 4.0
"""Time after a sweep within which a car comes to rest, s; the response of a car that does not is fitted with its rest."""


def step_steer(known: Known, test: StepSteer) -> list[Manoeuvre]:
    """Return a step of steering to a lateral acceleration."""
    steer, end = known.steer_for(test.lateral_acceleration), STEER_BEGIN + test.rise
    return [Manoeuvre(test.speed, end + 4.85, f"step5(t, {STEER_BEGIN}, 0, {end!r}, {steer!r})", output=0.005)]


def of_step_steer(known: Known, test: StepSteer, runs: list[Run]) -> Metrics:
    """Return response times, overshoot and gains of yaw rate and lateral acceleration."""
    run, found = runs[0], Metrics()
    for label, channel, unit in (("yaw rate", "yaw_rate", "1/s"), ("lateral acceleration", "ay", "m/s^2")):
        one = step_response(run["time"], run[SEEN] * known.ratio, run[f"vehicle.{channel}"])
        found |= {
            f"{label}, steady": (one.steady, "rad/s" if channel == "yaw_rate" else unit),
            f"{label}, gain per steer angle of the wheels": (
                one.gain,
                unit if channel == "yaw_rate" else f"{unit}/rad",
            ),
            f"{label}, response time": (one.response_time, "s"),
            f"{label}, peak response time": (one.peak_time, "s"),
            f"{label}, overshoot": (100 * one.overshoot, "%"),
        }
        if channel == "yaw_rate":
            sideslip = float(np.mean(run["vehicle.sideslip"][-100:]))
            found["TB factor"] = one.peak_time * abs(np.degrees(sideslip)), "s deg"
    return found


def frequency(known: Known, test: FrequencySweep) -> list[Manoeuvre]:
    """Return a sweep with an amplitude of a lateral acceleration of the quasi-steady turn, and the one of falling frequency.

    Both begin and end at rest: the transforms of the whole records have no error by their ends.
    """
    steer, end = known.steer_for(test.lateral_acceleration), STEER_BEGIN + test.duration
    size = f"({steer!r})*step5(t, {STEER_BEGIN}, 0, {STEER_BEGIN + 1}, 1)*step5(t, {end - 1!r}, 1, {end!r}, 0)"
    found = []
    for begin, last in ((test.first, test.last), (test.last, test.first)):
        rate = (last - begin) / test.duration
        phase = f"2*pi*(({begin!r})*(t - {STEER_BEGIN}) + ({rate!r})*(t - {STEER_BEGIN})^2/2)"
        found.append(Manoeuvre(test.speed, end + SETTLING, f"{size}*sin({phase})", output=0.01))
    return found


def of_frequency(known: Known, test: FrequencySweep, runs: list[Run]) -> Metrics:
    """Return gain, resonance and delay of the yaw rate, and delay of the lateral acceleration, with their error bars."""
    yaw, lateral = (response_of_sweeps(known.ratio, runs, f"vehicle.{channel}") for channel in ("yaw_rate", "ay"))
    found, at_1 = Metrics(), 1.0 if test.first <= 1.0 <= test.last else np.nan  # not outside of the sweep
    low = yaw.at(0.4)[0] if test.first <= 0.4 <= test.last else np.nan
    band = (yaw.frequency >= test.first) & (yaw.frequency <= test.last)
    gain, bar = np.where(band, yaw.gain, 0.0), yaw.gain * yaw.error
    peak = int(np.argmax(gain))
    near = yaw.frequency[band & (gain >= gain[peak] - bar[peak] - bar)]  # frequencies whose gain may be the largest
    reached = band.any()
    rows = (
        ("yaw rate, gain at 0.4 Hz", low, low * yaw.error_at(0.4), "1/s"),
        ("yaw rate, largest gain over that", gain[peak] / low, gain[peak] / low * (yaw.error[peak] + yaw.error_at(0.4)), ""),
        ("yaw rate, frequency of the largest gain", yaw.frequency[peak] if reached else np.nan, np.max(np.abs(near - yaw.frequency[peak])) if reached else np.nan, "Hz"),
        ("yaw rate, phase at 1 Hz", at_1 * np.degrees(yaw.at(1.0)[1]), np.degrees(yaw.error_at(1.0)), "deg"),
        ("lateral acceleration, phase at 1 Hz", at_1 * np.degrees(lateral.at(1.0)[1]), np.degrees(lateral.error_at(1.0)), "deg"),
    )  # fmt: skip
    for name, value, error, unit in rows:
        found[name] = float(value), unit
        found[f"{name}{BAR_OF}"] = (float(error) if np.isfinite(value) else np.nan), unit
    return found


def response_of_sweeps(ratio: float, runs: Sequence[Run], channel: str) -> FrequencyResponse:
    """Return the mean response of a channel to the steer angle of the wheels in both sweeps; its error bar contains both.

    `ratio`: steer angle of the wheels per unit of steering.
    """
    up, down = (frequency_response(run["time"], run[SEEN] * ratio, run[channel]) for run in runs)
    responses = [one.gain * np.exp(1j * one.phase) for one in (up, down)]
    mean = (responses[0] + responses[1]) / 2
    error = np.maximum(up.error, down.error) + np.abs(responses[0] - mean) / np.abs(mean)
    coherence = np.minimum(up.coherence, down.coherence)
    return FrequencyResponse(up.frequency, np.abs(mean), np.unwrap(np.angle(mean)), coherence, error)


def dwell_end(test: SineWithDwell) -> float:
    """Return the end of steering, s."""
    return STEER_BEGIN + 1 / test.frequency + test.dwell


def dwell_formula(amplitude: float, test: SineWithDwell) -> str:
    """Return the steering of ISO 19365: a sine with a dwell at its second peak."""
    first, third = 0.75 / test.frequency, 0.75 / test.frequency + test.dwell
    time = f"min(t - {STEER_BEGIN}, {first!r}) + max(t - {STEER_BEGIN + third!r}, 0)"
    return f"({amplitude!r})*sin(2*pi*{test.frequency!r}*min(max({time}, 0), {1 / test.frequency!r}))"


def amplitudes(known: Known, test: SineWithDwell) -> dict[str, float]:
    """Return the amplitudes of the steering joint by name: multiples of A up to the largest angle, and the final run."""
    unit, wheel = known.steer_for(test.lateral_acceleration), _wheel_angle(known, test)
    found = {f"{factor:g} A": factor * unit for factor in test.factors if abs(factor * unit) * wheel <= test.largest}
    last = min(max(LAST * abs(unit), test.final / wheel), test.largest / wheel)
    if not any(abs(abs(size) - last) < 1e-9 * last for size in found.values()):
        found[f"{np.degrees(last * wheel):.0f} deg"] = float(np.copysign(last, unit))
    return found


def _wheel_angle(known: Known, test: SineWithDwell) -> float:
    """Return the angle of the steering wheel per unit of the steering joint, rad/rad or rad/m."""
    return 1.0 if known.car.angular else 2 * np.pi / test.turn


def dwell(known: Known, test: SineWithDwell) -> list[Manoeuvre]:
    """Return the series of amplitudes to the left and to the right first, with the throttle released."""
    lifted, sizes = {"releases": STEER_BEGIN}, amplitudes(known, test).values()
    formulas = [dwell_formula(sign * size, test) for size in sizes for sign in SIDES.values()]
    return [Manoeuvre(test.speed, dwell_end(test) + 2.2, formula, lifted) for formula in formulas]


def of_dwell(known: Known, test: SineWithDwell, runs: list[Run]) -> Metrics:
    """Return the yaw-rate ratios and lateral displacements of both series, and the verdicts."""
    found, worst, displacements = Metrics(), [0.0, 0.0], []
    unit, wheel = abs(known.steer_for(test.lateral_acceleration)), _wheel_angle(known, test)
    names = [(size, name, side) for name, size in amplitudes(known, test).items() for side in SIDES]
    for (size, name, side), run in zip(names, runs, strict=True):
        time, steer = run["time"], run[SEEN]
        begun = first_time(time, np.abs(steer) * wheel, BEGUN)
        begin = begun if np.isfinite(begun) else STEER_BEGIN  # less steering than the angle at which it begins
        one = sine_with_dwell(
            time, steer * known.ratio, run["vehicle.yaw_rate"], run["vehicle.y"], begin, dwell_end(test)
        )
        for n, (after, ratio) in enumerate((("1 s", one.ratio_1), ("1.75 s", one.ratio_1_75))):
            found[f"yaw rate ratio after {after}, {name}, {side}"] = 100 * ratio, "%"
            worst[n] = max(worst[n], abs(ratio))
        if abs(size) >= RESPONSIVE * unit:
            found[f"lateral displacement, {name}, {side}"] = one.displacement, "m"
            displacements.append(one.displacement)
    least = min(displacements, default=np.nan)
    return found | {
        "steering-wheel angle of A": (float(np.degrees(unit * wheel)), "deg"),
        "largest yaw rate ratio after 1 s": (100 * worst[0], "%"),
        "largest yaw rate ratio after 1.75 s": (100 * worst[1], "%"),
        "lateral displacement, 5 A and more": (least, "m"),
        f"stable{YES_OR_NO}": (float(worst[0] <= STABLE[0] and worst[1] <= STABLE[1]), ""),
        f"responsive{YES_OR_NO}": (float(least >= test.displacement), ""),
    }
