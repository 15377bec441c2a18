"""Decisions of the search for events within a step."""

from __future__ import annotations

import numpy as np

from stiffmbs.reading.table import Table
from stiffmbs.solve.events import narrow_inputs
from stiffmbs.solve.events.departures import Departure
from stiffmbs.solve.events.native import bounds, nearby, outside, sign_changes, signs_at_zero, within_step
from tests.decisions.common import Record, never, nothing, searched
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def deviation_from_a_cubic():
    w = searched()
    w.m += 0.01
    return within_step._mismatch(w, 1.0, 0.0)


def search(w, mismatch=lambda *_: 0.0, **replaced):
    """Follow an event function of value 0 through a step; return the lengths of the parts."""
    parts = []
    found = {
        "_values": lambda *_: np.zeros(1), "_first_within": lambda *_: 2.0, "_note_noise": nothing,
        "_mismatch": lambda w, part, noise: parts.append(part) or mismatch(len(parts)), **replaced,
    }  # fmt: skip
    with interpreted(within_step, **found):
        within_step.first_event(w, None, 0.0, 1.0)
    return parts


def depth_of_rounding():
    w = searched(row=np.full(2, 1e9))
    search(w)
    return w.depth


def parts_after_short_ones(deviation):
    """Return the number of parts of a step after parts of 1/64, at a deviation from the cubic."""
    return len(search(searched(), lambda count: 2.0 if count <= 12 else deviation)) - 12


def last_part_that_is_halved():
    """Return the number of parts, in tens, after which parts are no longer halved because arguments of sines turn too far."""

    def is_halved(tens):
        count = []

        def turned(w, part):
            return count.append(1) or (2.0 if len(count) <= 8 or len(count) == 10 * tens else 0.6)

        w = searched(n_turns=1, value_before=np.array([1e9]), rate_before=np.zeros(1), b=np.zeros(1))

        def found(*_):
            return 0.0 if len(count) > 10 * tens else 2.0

        parts = search(w, lambda *_: 0.5, _turned_in_part=turned, note_unresolved=nothing, _first_within=found)
        return parts[10 * tens] < parts[10 * tens - 1]

    return count_while(is_halved, range(1, 30))


def shortest_part():
    with interpreted():
        return within_step._longest_part(searched(n_angles=1, row=np.array([1e9, 0.0]), n_nodes=2))


def refined_at_an_extremum():
    """Return the number of parabolas at an extremum, and the first interval of them."""
    places = []

    def values(w, s, begun, h, place):
        places.append(place)
        return np.array([(place - 0.5) ** 2])

    with interpreted(within_step, _values=values, _visits=never):
        within_step._visits_extremum(searched(), None, 0.0, 1.0, 0, 0.0, 0.5, 1.0)
    return len(places) / 3, places[2] - places[0]


def time_past_an_event():
    s, m = Record(q=np.zeros(1), n_q=1), Record(n_trailing=0)
    replaced = {
        "_go": nothing,
        "evaluate": lambda *_: np.zeros(1),
        "_passed": lambda s, m, t, ahead, *_: int(ahead >= 1e-3),
    }
    with interpreted(sign_changes, **replaced):
        return sign_changes.moved_past(s, m, 0.0, 1.0, 1, np.zeros(1), np.zeros(1))


def signs_to_a_side():
    signs, seen, held = np.zeros(1), np.zeros(1), np.zeros(1)
    return count_while(lambda _: signs_at_zero.note_signs(signs, np.ones(1), seen, held, 1) > 0, range(100))


def steepest_without_an_extremum():
    """Return the rate at one end, in tenths of the change between the ends, up to which there is no extremum."""
    return count_while(lambda k: bounds._bound(0.0, 0.1 * k, 1.0, 0.0, 0.0, 1) <= 0.06 * k, range(30, 400))


def farthest_that_is_near():

    def near(k):
        return nearby._is_near(
            searched(value_before=np.array([0.1 * k]), value_after=np.array([0.1 * k]), rate_before=np.ones(1)), 1.0, 0
        )

    return count_while(near, range(1, 200))


def rotation(is_too_far):
    """Return the rotation of a body, in hundredths of a radian, up to which a step is not searched."""
    w = searched(n=0, n_angles=1, n_event_functions=0)
    return count_while(lambda k: not is_too_far(w, 1.0, [0.0], [0.01 * k]), range(1, 400))


def narrowest_peak():
    """Return the height of a peak, relative to the input and in quarter octaves, down to which it is more than rounding."""
    times = np.linspace(0.0, 1.0, 11)
    features = Record(breakpoints=np.array([0.55]), instants=lambda *_: np.empty(0))

    def is_seen(height):
        pulse = Record(text="f", at=lambda t: np.where(t == 0.55, 1.0 + height, 1.0))
        return bool(narrow_inputs.hidden_peak([pulse], features, times))

    return count_while(is_seen, HALVES)


def time_outside():
    """Return the part of a step for which a straight function is noted as outside, which it is for 4.5 % of it."""
    w = Record(
        begun=0.0, noted=np.inf, n=1, n_event_functions=0, first_breakpoint=[0, 2], breakpoints=[-1.0, 0.955], tables=[1],
        value_before=[0.0], value_after=[1.0], rate_before=[1.0], rate_after=[1.0], near=[0], call=[0], lowest=[0.0],
        highest=[0.0], outside=[0.0], left=[np.inf], m=[0.0],
    )  # fmt: skip
    with interpreted(outside):
        outside.note_outside(w, 1.0)
    return w.outside[0]


def farthest_that_is_no_departure():
    """Return the distance from a table, in quarter octaves of 1e-12 of its range, that is rounding."""
    table = Table(table=((0.0, 0.0), (1.0, 1.0)))
    return count_while(lambda d: not Departure("", "", table, (0.0, 1.0 + 1e-12 * d), 0.0, 0.0).matters, DOUBLES)


DECISIONS = {
    "solve.events.native.outside:PARTS": time_outside,
    "solve.events.departures:ROUNDING": farthest_that_is_no_departure,
    "event_search.margin": lambda: bounds._bound(1.0, 0.0, 2.0, 0.0, 0.0, 1) - 2.0,
    "event_search.unknown": lambda: bounds._bound(1.0, 0.0, 1.0, 0.0, 0.01, 1) - 1.0,
    "event_search.steep": steepest_without_an_extremum,
    "event_search.turned": lambda: rotation(bounds.suspicious),
    "event_search.clear": farthest_that_is_near,
    "event_search.hardly_turned": lambda: rotation(nearby.note_near),
    "event_search.fits": deviation_from_a_cubic,
    "event_search.precision": narrowest_peak,
    "event_search.shallow": depth_of_rounding,
    "event_search.well": lambda: count_while(lambda missed: parts_after_short_ones(missed) > 40, HALVES),
    "event_search.finest": shortest_part,
    "event_search.few_parts": last_part_that_is_halved,
    "event_search.difference": lambda: bounds.time_of_difference(Record(duration=0.0), 1.0, 0.0),
    "event_search.least_difference": lambda: bounds.time_of_difference(Record(duration=1.0), 0.0, 0.0),
    "event_search.refinements": lambda: refined_at_an_extremum()[0],
    "event_search.refined": lambda: refined_at_an_extremum()[1],
    "event_search.longer": time_past_an_event,
    "event_search.held": signs_to_a_side,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "solve.events.native.outside:PARTS": 0.0625, "solve.events.departures:ROUNDING": 40,
    "event_search.margin": 0.1, "event_search.unknown": 0.08, "event_search.steep": 51, "event_search.turned": 100, "event_search.clear": 40,
    "event_search.hardly_turned": 30, "event_search.fits": 0.25, "event_search.precision": 120, "event_search.shallow": 1e-05,
    "event_search.well": 21, "event_search.finest": 0.0001, "event_search.few_parts": 9, "event_search.difference": 1e-06,
    "event_search.least_difference": 1e-09, "event_search.refinements": 5, "event_search.refined": 0.02, "event_search.longer": 0.0625,
    "event_search.held": 2,
}  # fmt: skip
"""The decisions of the default parameters."""
