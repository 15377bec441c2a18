"""Features of inputs over time: found by ranges, seen by every solver, at no cost where there are none."""

import json

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad
from scipy.interpolate import Akima1DInterpolator, CubicSpline

import stiffmbs
from stiffmbs import AppliedForce, Body, Model
from stiffmbs.compile.compile_model import compile_model
from stiffmbs.compile.inputs import ends, of_time
from stiffmbs.compile.inputs.enclosed_functions import FUNCTIONS
from stiffmbs.compile.inputs.features import InputFeatures, breakpoint_times, input_features
from stiffmbs.compile.inputs.interval_arithmetic import Enclosure
from stiffmbs.compile.inputs.of_time import Input
from stiffmbs.compile.inputs.table_ranges import TableRanges
from stiffmbs.compile.symbolic.symbols import SMOOTH
from stiffmbs.compile.table_values import curve
from stiffmbs.reading.formula.text import parse
from stiffmbs.reading.table import Table
from stiffmbs.verification.verify import verify

WAYS = ({"solver": "bdf"}, {"solver": "projected", "scheme": "dopri5"}, {"solver": "projected", "scheme": "dop853"})
TIMES = np.arange(0, 10.001, 0.002)
SHOCK = np.where((TIMES > 7.999) & (TIMES < 8.011), 1000 * np.sin(np.pi * (TIMES - 8) / 0.011), 0.0)
PULSE = {"table": [[0, 0], [8, 0], [8.05, 1000], [8.1, 0], [10, 0]], "lines": True}


def scene(force, **tables):
    """2 kg at rest under a force over time."""
    found = {
        "gravity": [0, 0],
        "bodies": {"b": {"mass": 2, "inertia": 1}},
        "forces": {"f": {"type": "force", "i": "b", "force": [force, 0]}},
    }
    return stiffmbs.read_scene(json.dumps(found | ({"tables": tables} if tables else {})))


def test_features_of_an_input_are_those_of_what_it_says():
    """They are sought once for scenes that say the same, and anew for another number, span or table under the same name."""

    def found(force, end=10.0, **tables):
        return input_features(compile_model(scene(force, **tables)), 0.0, end)

    assert found("step(t, 3, 0, 4, 1)") is found("step(t, 3, 0, 4, 1)")
    assert found("max(t - 3, 0)").breakpoints == pytest.approx([3])
    assert found("max(t - 5, 0)").breakpoints == pytest.approx([5])
    assert not len(found("max(t - 5, 0)", end=4.0).breakpoints)
    for middle in (3.0, 5.0):
        assert middle in found("law(t)", law={"table": [[0, 0], [middle, 1], [10, 0]], "lines": True}).breakpoints


def driven(position):
    """2 kg led along a rail."""
    joints = {"rail": {"type": "prismatic", "i": "b", "j": "ground"}}
    joints["motor"] = {"type": "drive", "joint": "rail", "position": position}
    return stiffmbs.read_scene(
        json.dumps({"gravity": [0, 0], "bodies": {"b": {"mass": 2, "inertia": 1}}, "joints": joints})
    )


def features(force, end=10.0, **tables):
    return input_features(stiffmbs.compile_model(scene(force, **tables)), 0.0, end)


def shock(noise=0.0, **how):
    values = SHOCK + noise * np.random.default_rng(0).standard_normal(len(TIMES))
    return {"table": np.column_stack([TIMES, values]).tolist(), **how}


INPUTS = {
    "p(min(t, 9))": ({"p": PULSE}, 50.0),
    "p(max(t - 1, 0))": ({"p": PULSE}, 50.0),
    "p(branch(t - 3, 0, 3, t))": ({"p": PULSE}, 50.0),
    "p(q(t))": ({"p": PULSE, "q": {"table": [[0, 0], [5, 10]], "lines": True}}, 25.0),
    "1000*exp(-((t - 8)/0.5 ms)^2)": ({}, 0.5 * np.sqrt(np.pi)),
    "b.x*0 + 1000*exp(-((t - 8)/0.5 ms)^2)": ({}, 0.5 * np.sqrt(np.pi)),
    "1e6*exp(-((t - 8.1234)/1e-6)^2)": ({}, np.sqrt(np.pi)),
    "1000*(tanh((t - 8)/1e-3) - tanh((t - 8.002)/1e-3))": ({}, 4.0),
    "sqrt((t - 8)^2)": ({}, 34.0),
    "1000/(1 + ((t - 8)/1e-3)^2)": ({}, np.arctan(2000) + np.arctan(8000)),
    "1000/cosh((t - 8)/1e-3)": ({}, np.pi),
    "1000*max(0, step(abs(t - 8.0005), 0, 1, 0.0005, 0))": ({}, 0.5),
    "1e6*abs(max(0, 0.0005 - abs(t - 8)))": ({}, 0.25),
    "shock(t)": ({"shock": shock()}, CubicSpline(TIMES, SHOCK, bc_type="natural").integrate(0, 10)),
    "noisy(t)": ({"noisy": shock(1e-6)}, CubicSpline(TIMES, SHOCK, bc_type="natural").integrate(0, 10)),
    "akima(t)": ({"akima": shock(akima=True)}, Akima1DInterpolator(TIMES, SHOCK).antiderivative()(10.0)),
}


LONG = ("noisy(t)", "akima(t)")


@pytest.mark.sampled(10)
@pytest.mark.parametrize("how", WAYS, ids=str)
@pytest.mark.parametrize(
    "force", [pytest.param(force, marks=pytest.mark.long if force in LONG else ()) for force in INPUTS]
)
def test_every_solver_sees_a_short_input_after_a_long_rest(force, how):
    tables, impulse = INPUTS[force]
    solution = stiffmbs.run(scene(force, **tables), duration=10.0, points=11, rtol=1e-6, **how)
    assert solution["b.vx"][-1] == pytest.approx(impulse / 2, rel=1e-4)


@pytest.mark.parametrize("force", ["3", "t^2 - 4*t", "b.x", "abs(t - 3)", "step(t, 2, 0, 5, 1)", "p(t)"])
def test_inputs_without_narrow_features_bound_no_step(force):
    assert len(features(force, p=PULSE).starts) == 0


@pytest.mark.parametrize("frequency", [1.0, 1000.0, 1e6])
def test_a_sine_is_bounded_alike_at_each_frequency_and_by_half_a_turn_at_the_least(frequency):
    found = features(f"sin(2*pi*{frequency}*t)")
    assert len(found.breakpoints) == 0 and len(found.starts) < 20
    assert 0.5 < np.min(found.longest) * frequency < 1.0


@pytest.mark.long
def test_inputs_with_too_many_features_are_told_and_followed():
    assert "too many features" in features("sin(2e7*pi*t)").note
    assert not features("sin(2000*pi*t)").note


@pytest.mark.long
def test_a_pulse_of_a_microsecond_in_1000_s_is_found_wherever_it_is():
    for c in np.random.default_rng(1).uniform(0, 1000, 20):
        length, t = features(f"exp(-((t - {c:.17g})/1e-6)^2)", end=1000.0).narrowest()
        assert 1e-7 < length < 3e-6
        assert abs(t - c) < 1e-5


def test_a_flat_zero_is_one_feature():
    assert len(features("1000*max(0, step(abs(t - 8.0005), 0, 1, 0.0005, 0))").breakpoints) == 3
    assert len(features("abs(sin(t)^2 + cos(t)^2 - 1)").starts) == 0


def test_corners_of_tables_of_tables_and_of_all_of_several():
    table = {"table": [[0, 0], [1, 0], [2, 3], [5, 3]], "lines": True}
    other = {"table": [[0, 0], [4, 2]], "lines": True}
    np.testing.assert_allclose(features("p(q(t))", p=table, q=other).breakpoints, [2, 4], atol=1e-9)
    np.testing.assert_allclose(features("max(0, t - 2, 3*t - 8)").breakpoints, [2, 3], atol=1e-9)
    np.testing.assert_allclose(features("p(t^2)", p=table).breakpoints, np.sqrt([1, 2, 5]), atol=1e-9)
    np.testing.assert_allclose(features("b.x*p(3 - t)", p=table).breakpoints, [1, 2, 3], atol=1e-9)


@pytest.mark.long
def test_nested_steps_take_no_longer_than_their_number():
    """Fourteen steps within each other, and a part that is written twice at each of fourteen levels."""
    nested = doubled = "t/10"
    for _ in range(14):
        nested, doubled = (
            f"step({nested}, 0.1, 0, 0.9, 1)",
            f"({doubled})*sin({doubled})" if len(doubled) < 400 else doubled,
        )
    for text in (nested, doubled):
        given = Input(parse(text), text, {}, {})
        found = given.within(np.array([0.0]), np.array([1.0]), order=3)
        assert np.isfinite(found.value).all()
    assert len(breakpoint_times([Input(parse(nested), nested, {}, {})], 0.0, 10.0)) >= 2


def test_the_curvature_of_a_force_jumps_at_the_points_of_a_curve():
    """These are no breakpoints; splines have none, and points of lines and those of a drive are breakpoints."""
    points = [[0, 0], [2, 1], [5, 3], [7, -1], [10, 0]]
    for how, bends, breakpoints in (
        ({}, [2, 5, 7], []), ({"akima": True}, [2, 5, 7], []), ({"spline": True}, [], []), ({"lines": True}, [], [2, 5, 7]),
    ):  # fmt: skip
        found = features("law(t)", law={"table": points, **how})
        assert found.bends == pytest.approx(bends)
        assert found.breakpoints == pytest.approx(breakpoints)
    several = features("law(2*t) + max(t - 2.5, 0)", law={"table": points})
    assert several.bends == pytest.approx([1, 3.5])  # at 2.5 s is a breakpoint
    assert several.breakpoints == pytest.approx([2.5, 5])  # beyond its end the table is straight
    assert several.within(2.0, 4.0).bends == pytest.approx([3.5])


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "kind", ["leaves a point", "reaches a point", "leaves another function", "leaves a level in between"]
)
def test_the_end_of_a_rest_is_found_to_the_last_digit(kind):
    """The interval of 1e-11 s that holds it was taken for it: velocities of drives jumped within the steps after it."""
    rng = np.random.default_rng(0)
    table = {"table": [[0, 0], [4, 0], [5, 1], [10, 0]], "spline": True}
    for t in rng.uniform(0.2, 4.0, 20).tolist():
        text = {
            "leaves a point": f"p(max(t - {t!r}, 0))",
            "reaches a point": f"p(max({t!r} - t, 0))",
            "leaves another function": f"max(0, max(t - {t!r}, 0)*t)",
            "leaves a level in between": f"abs(max(t - {t!r}, 0) + min(t - 0.1, 0))",
        }[kind]
        found = features(text, p=table).breakpoints
        assert np.abs(found - t).min() <= 2e-16 * t, (t, found)


@pytest.mark.long
def test_a_force_with_too_many_points_bends_nowhere():
    """A run with such a force is not refused: only breakpoints are to be stopped at."""
    many = {"table": [[0, 0], [0.3e-6, 1], [0.6e-6, -1], [1e-6, 0]], "beyond": "repeat"}
    assert not len(features("law(t)", law=many).bends)


def test_a_step_is_no_longer_than_what_it_touches_allows():
    found = InputFeatures(np.empty(0), np.array([0.0, 4.0, 5.0]), np.array([10.0, 0.1, np.inf]))
    assert found.longest_step(0.0) == 4.0
    assert found.longest_step(3.95) == pytest.approx(0.1)
    assert found.longest_step(4.5) == 0.1
    assert found.longest_step(5.0) == np.inf


def _ramp(x, x0, h0, x1, h1, rise):
    z = (x - x0) / (x1 - x0)
    return sp.Piecewise((h0, x <= x0), (h1, x >= x1), (h0 + (h1 - h0) * rise(z), True))


BY_PIECES = {
    "abs": lambda x: sp.Piecewise((x, x >= 0), (-x, True)),
    "min": lambda x, other: sp.Piecewise((x, x <= other), (other, True)),
    "max": lambda x, other: sp.Piecewise((x, x >= other), (other, True)),
    "step": lambda *x: _ramp(*x, rise=lambda z: z**2 * (3 - 2 * z)),
    "step5": lambda *x: _ramp(*x, rise=lambda z: z**3 * (10 - 15 * z + 6 * z**2)),
}


def _derivatives(name, others):
    x = sp.Symbol("x", real=True)
    expression = (SMOOTH | BY_PIECES)[name](x, *others)
    return [sp.lambdify(x, expression.diff(x, k) / sp.factorial(k), "numpy") for k in range(4)]


OTHERS = {"atan2": (0.5,), "min": (0.3,), "max": (-0.3,), "step": (-1, 0.2, 2, 0.7), "step5": (-1, 0.7, 2, 0.2)}


@pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - {"branch", "sign"}))
def test_enclosures_hold_taylor_coefficients(name):
    """Up to the third, of each function of a bent argument, against SymPy's derivatives."""
    rng = np.random.default_rng(0)
    low = rng.uniform(-4, 4, 300)
    high = low + 10.0 ** rng.uniform(-3, 0, 300)
    times = low[:, None] + (high - low)[:, None] * np.linspace(0.001, 0.999, 50)
    others = OTHERS.get(name, ())
    with np.errstate(all="ignore"):
        found = FUNCTIONS[name](Enclosure.of_time(low, high, order=3), *others)
        defined = np.ones_like(times, dtype=bool)
        for k, derivative in enumerate(_derivatives(name, others)):
            exact = np.broadcast_to(np.asarray(derivative(times), dtype=complex), times.shape)
            defined &= np.isfinite(exact) & (exact.imag == 0)
            least, greatest = (np.broadcast_to(end[:, None], times.shape) for end in found[k])
            close = 1e-9 * (1 + np.abs(exact.real))
            assert np.all((least <= exact.real + close)[defined] & (exact.real <= greatest + close)[defined])


@pytest.mark.parametrize(
    "how", [{"lines": True}, {"akima": True}, {}, {"ends": "periodic"}, {"ends": "clamped"}], ids=str
)
def test_ranges_of_tables_hold_their_values_and_slopes(how):
    rng = np.random.default_rng(0)
    y = rng.uniform(-1, 1, 12)
    y[-1] = y[0]
    table = Table(table=tuple(zip(np.cumsum(rng.uniform(0.1, 1, 12)), y, strict=True)), **how)
    low = rng.uniform(-3, 12, 400)
    high = low + 10.0 ** rng.uniform(-3, 1, 400)
    times = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, 200)
    with np.errstate(all="ignore"):
        found = TableRanges(table).enclosed(Enclosure.of_time(low, high, order=3))
    values = curve(table)(times)
    assert np.all(found.value[0][:, None] <= values + 1e-9) and np.all(values <= found.value[1][:, None] + 1e-9)
    rates = np.diff(values) / np.diff(times)
    assert np.all(found.slope[0][:, None] <= rates + 1e-6) and np.all(rates <= found.slope[1][:, None] + 1e-6)


@pytest.mark.long
def test_a_kinematic_peak_between_output_points_is_told_and_found_by_verify():
    pulse = driven("1e-3*exp(-((t - 0.505)/1 ms)^2)")
    how = {"duration": 1.0, "points": 101, "solver": "kinematic"}
    assert any("shorter than the 0.01 s between output times" in note for note in stiffmbs.run(pulse, **how).notes)
    found = verify(pulse, **how)
    peak = 2 * 2e-3 / 1e-6
    assert found.errors["motor.fx"].least == pytest.approx(peak, rel=0.3)
    assert any("peaks lie between the output times" in note for note in found.notes)
    wide = stiffmbs.run(driven("1/(1 + ((t - 8.25)/0.49)^2)"), duration=10.0, points=21, solver="kinematic")
    assert any("a peak of 1 at t = 8.25 s, between output times" in note for note in wide.notes)
    bent = stiffmbs.run(driven("max(0, 1 - abs(t - 8.25))"), duration=10.0, points=21, solver="kinematic")
    assert any("a peak of 1 at t = 8.25 s, between output times" in note for note in bent.notes)
    quiet = stiffmbs.run(driven("1e-3*sin(t)"), **how)
    assert not any("output times" in note for note in quiet.notes)


def test_a_kinematic_drive_may_bend_at_the_very_start():
    solution = stiffmbs.run(driven("max(0, t)"), duration=1.0, points=11, solver="kinematic")
    np.testing.assert_allclose(solution["b.x"], solution.t, atol=1e-12)


def test_fixed_steps_tell_of_shorter_features():
    how = {"duration": 1.0, "points": 11, "solver": "projected", "scheme": "rk4"}
    notes = stiffmbs.run(scene("exp(-((t - 0.5)/1e-4)^2)"), **how).notes
    assert any("shorter than the steps of 0.001 s of rk4" in note for note in notes)
    assert not any("rk4" in note for note in stiffmbs.run(scene("sin(t)"), **how).notes)


def test_a_drive_by_the_root_of_a_square_turns_round():
    solution = stiffmbs.run(driven("sqrt((t - 0.52)^2)"), duration=1.0, points=11, solver="kinematic")
    np.testing.assert_allclose(solution["b.x"], np.abs(solution.t - 0.52), atol=1e-9)


DRIVES = {
    "min(2*t, 1)": (lambda t: np.minimum(2 * t, 1), [0.5]),
    "max(0, 2*t - 18.5)": (lambda t: np.maximum(0, 2 * t - 18.5), [9.25]),
    "abs(sin(0.5*pi*t))": (lambda t: np.abs(np.sin(0.5 * np.pi * t)), [2, 4, 6, 8]),
    "sqrt((t - 7.3)^2) - sqrt((t - 7.83)^2)": (lambda t: np.abs(t - 7.3) - np.abs(t - 7.83), [7.3, 7.83]),
}


@pytest.mark.parametrize("how", [*WAYS, {"solver": "auto"}], ids=str)
@pytest.mark.parametrize("position", DRIVES)
def test_behind_a_corner_a_drive_leads_with_its_new_velocity(position, how):
    """It pushes a free mass, and no force tells in which steps its velocity was the old one."""
    given = {
        "gravity": [0, 0],
        "bodies": {"b": {"mass": 2, "inertia": 1}, "g": {"mass": 1, "inertia": 1}},
        "joints": {
            "rail": {"type": "prismatic", "i": "b", "j": "ground"},
            "motor": {"type": "drive", "joint": "rail", "position": position},
        },
        "forces": {"f": {"type": "force", "i": "g", "force": ["b.x", 0]}},
    }
    solution = stiffmbs.run(stiffmbs.read_scene(json.dumps(given)), duration=10.0, points=11, rtol=1e-8, **how)
    values, breakpoints = DRIVES[position]
    assert solution["g.vx"][-1] == pytest.approx(quad(values, 0, 10, points=breakpoints)[0], abs=1e-5)
    assert any("a drive makes velocities jump" in note for note in solution.notes)


@pytest.mark.parametrize("ending", ["t", "body.x"])
def test_long_formulas_are_looked_through_once(monkeypatch, ending):
    """However many terms a formula has, each of its nodes is asked once whether it is of time."""
    terms = 200
    model = Model()
    model.add("body", Body(mass=1, inertia=1))
    model.add("push", AppliedForce(i="body", force=(" + ".join(["body.x*body.y"] * terms + [ending]), 0)))
    system, asked = compile_model(model.data()), []
    for module in (of_time, ends):
        found = module.parts_of
        monkeypatch.setattr(module, "parts_of", lambda *which, found=found: asked.append(which) or found(*which))
    assert len(of_time.inputs_of(system)) == (ending == "t")
    assert ends.first_input_end(system, 0.0, 1.0) is None
    assert len(asked) <= 30 * terms


@pytest.mark.parametrize("solver", ["bdf", "radau", "auto"])
def test_a_pulse_by_a_hyperbolic_cosine_is_not_missed(solver):
    """The impulse of F/cosh((t - 3)/T) is pi F T: the velocity of 1 kg."""
    width = 2e-4
    scene = stiffmbs.read_scene(
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1}}\n"
        f"forces: {{f: {{type: force, i: b, force: [1e3/cosh((t - 3)/{width}), 0]}}}}\n"
        f"run: {{duration: 10, points: 3, rtol: 1e-6, solver: {solver}}}\n"
    )
    assert stiffmbs.run(scene)["b.vx"][-1] == pytest.approx(1e3 * np.pi * width, rel=1e-3)
