"""Units in formulas: what does not fit is refused in a sentence, and what is written without units is taken in SI."""

import json
import math

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import stiffmbs
from stiffmbs import AppliedTorque, Drive, InputError, LineForce
from stiffmbs.reading.formula.measured import dimension_of
from stiffmbs.reading.formula.text import OF_NUMBERS, FormulaError, evaluate, parse
from stiffmbs.reading.units.quantity import VALUES, in_si
from stiffmbs.reading.units.units import UNITS, Quantity
from stiffmbs.spatial import in_space

from ..conftest import EXAMPLE_SCENES

PLANE = {
    "parameters": {"k": "5 N/m", "F": "5 N", "w": 3, "n": 2, "c": "2 N s/m"},
    "tables": {"push": {"table": [[0, 0], [1, 1]]}},
    "bodies": {"a": {"mass": 1, "inertia": 1}, "b": {"mass": 1, "inertia": 1, "position": [1, 0]}},
}
SPACE = PLANE | {
    "dimensions": 3,
    "bodies": {name: {**body, "inertia": [1, 1, 1], "position": [*body.get("position", [0, 0]), 0]} for name, body in PLANE["bodies"].items()},
}  # fmt: skip


def read(section, family=PLANE, **entries):
    return stiffmbs.read_scene(json.dumps(family | {section: entries}))


def force(formula):
    return {"type": "force", "i": "a", "force": [formula, 0]}


@pytest.mark.parametrize(
    "formula",
    [
        "5", "sin(t)", "-100*a.x", "-a.x^3", "w*t", "a.x + a.angle", "exp(-t)", "-0.1*vm(a)*vx(a)",  # plain SI numbers
        "F", "2*F", "-k*a.x", "-k*(a.x - 0.3)", "-k*(dm(a, b) - 1 m)", "F*sin(t)", "F*sin(w*t)", "F*cos(a.angle + 20 deg)",
        "F*sin(2*pi*50 Hz*t)", "F*sin(3000 rpm*t)", "F*exp(-t/0.1)", "k*a.x^n/1 m", "sqrt(F^2 + (k*a.x)^2)",
        "step(t, 0.1, 0, 0.2 s, F)", "step5(a.x, 0, 0, 1 mm, 5)", "min(F, 3)", "max(F, k*a.x, 0)", "F*sign(a.vx)",
        "F*a.vx/abs(a.vx)", "F*tanh(a.vx/0.01)", "F*tanh(a.vx/1 cm*1 s)", "branch(t, F, 0, 3 kN)", "-c*a.vx", "F*push(t)",
        "k*push(t)", "k*1 m*push(t/1 s)", "F*atan2(dy(a, b), dx(a, b))", "5 N + 2*a.x", "3 lbf", "2 kg*g0", "2 kg*1 g0",
    ],
)  # fmt: skip
def test_formulas_that_fit(formula):
    read("forces", f=force(formula))


@pytest.mark.parametrize(
    "formula, words",
    [
        ("3 kg", "forces.f.force.0: found '3 kg', which is in kg, expected a force in N"),
        ("2*3 kg", "found '2.3 kg', which is in kg, expected a force in N"),
        ("k", "which is in N/m, expected a force"),
        ("F*t", "which is in kg m s.-1, expected a force in N"),
        ("F*dm(a, b)", "which is in N m, expected a force in N"),
        ("F + a.x", r"found N and m in 'F \+ a.x', expected one unit in both"),
        ("a.x + a.angle + 3 kg", r"found m and no unit in 'a.x \+ a.angle', expected one unit"),
        ("a.x + 3 kg", r"found m and kg in 'a.x \+ 3 kg'"),
        ("min(F, 3 kg)", r"found N and kg in 'min\(F, 3 kg\)'"),
        ("step(t, 1 m, 0, 2 s, F)", "found s and m in 'step"),
        ("step(t, 0, 1 m, 2 s, F)", "found m and N in 'step"),
        ("branch(t, F, 0, 3 m)", "found N and m in 'branch"),
        ("F*sin(3 m)", "found m in '3 m', expected a plain number or an angle"),
        ("F*sin(1 m/s*t)", r"found m in '1 m / s \* t', expected a plain number or an angle"),
        ("F^t", "found the exponent 't' of a quantity with a unit"),
        ("F^(2 s)", "found s in '2 s', expected a plain number"),
        ("F*atan2(1 m, 2 s)", "found m and s in 'atan2"),
    ],
)
def test_formulas_that_do_not_fit(formula, words):
    with pytest.raises(InputError, match=words):
        read("forces", f=force(formula))


@pytest.mark.parametrize(
    "section, entry, words",
    [
        ("forces", {"type": "torque", "i": "a", "torque": "5 N"}, "forces.e.torque: found '5 N', which is in N, expected a torque in N m"),
        ("forces", {"type": "line_force", "i": "a", "j": "b", "force": "5 N m"}, "expected a force in N"),
        ("forces", {"type": "spring_damper", "i": "a", "j": "b", "spring_law": "5 N*s"}, "spring_law: found '5 N.s', which is in N m"),
        ("forces", {"type": "spring_damper", "i": "a", "j": "b", "damper_law": "k*v"}, "damper_law: found 'k.v', which is in W|kg m s.-3"),
        ("forces", {"type": "torsion_spring", "i": "a", "j": "b", "spring_law": "5 N*s"}, "which is in N, expected a torque"),
        ("forces", {"type": "bushing", "i": "a", "j": "b", "law_angle": "k*s"}, "law_angle: found 'k.s', which is in N/m"),
        ("requests", "a.x + a.angle + 3 kg", "requests.e: found m and no unit"),
        ("requests", "a.vx + F", "requests.e: found m/s and N"),
    ],
)  # fmt: skip
def test_every_field_knows_its_dimension(section, entry, words):
    with pytest.raises(InputError, match=words):
        read(section, e=entry)


@pytest.mark.parametrize(
    "entry",
    [
        {"type": "spring_damper", "i": "a", "j": "b", "spring_law": "5 N/m*s + 3 N/m^3*s^3", "damper_law": "c*v*abs(v)/1 m*1 s"},
        {"type": "torsion_spring", "i": "a", "j": "b", "spring_law": "5 N m*s", "damper_law": "3 N m s*v"},
        {"type": "bushing", "i": "a", "j": "b", "law_x": "k*s", "law_angle": "1 N m*s"},
    ],
)  # fmt: skip
def test_laws_with_units(entry):
    read("forces", e=entry)


@pytest.mark.parametrize(
    "drive, found",
    [
        ({"joint": "pin", "velocity": "100 rad/s"}, None),
        ({"joint": "pin", "velocity": "3000 rpm"}, None),
        ({"joint": "pin", "velocity": "2*pi*50 Hz"}, None),
        ({"joint": "pin", "position": "20 deg*sin(3*t)"}, None),
        ({"joint": "rail", "position": "3 mm + 2 m/s*t"}, None),
        ({"joint": "rail", "velocity": "2*t"}, None),
        ({"coordinate": "a.x", "position": "3 mm*t/1 s"}, None),
        ({"coordinate": "2*a.angle", "velocity": "3 rpm"}, None),
        ({"joint": "pin", "velocity": "100 kg"}, "joints.e.velocity: found '100 kg', which is in kg, expected a velocity in rad/s"),
        ({"joint": "pin", "velocity": "1 m/s"}, "found '1 m/s', which is in m/s, expected a velocity in rad/s"),
        ({"joint": "pin", "velocity": "50 Hz"}, "found Hz in '50 Hz', which is 1/s, expected rad/s, rpm"),
        ({"joint": "pin", "position": "3 mm"}, "joints.e.position: found '3 mm', which is in m, expected a position in rad"),
        ({"joint": "rail", "position": "20 deg"}, "which is without a unit, expected a position in m"),
        ({"coordinate": "a.x", "velocity": "3 m"}, "which is in m, expected a velocity in m/s"),
    ],
)  # fmt: skip
def test_a_drive_has_the_unit_of_its_coordinate(drive, found):
    joints = {
        "pin": {"type": "revolute", "i": "a", "j": "ground"},
        "rail": {"type": "prismatic", "i": "b", "j": "ground"},
        "e": {"type": "drive", **drive},
    }
    if found is None:
        read("joints", **joints)
    else:
        with pytest.raises(InputError, match=found):
            read("joints", **joints)


@pytest.mark.parametrize(
    "request_, found",
    [
        ("accx(a) + 3 m/s^2 + a.ax", None),
        ("fx(pin) + 3 N + pin.fy", None),
        ("ax(a) + 3 deg", None),
        ("floor(a.x/1 mm)", None),
        ("mod(a.x, 1 mm)", None),
        ("tz(pin) + 3 N", "requests.e: found N m and N"),
        ("az(a) + a.az + 3 deg", "found no unit and m/s.2"),
        ("floor(3 mm)", "found m in '3 mm', expected a plain number"),
    ],
)
def test_requests_in_space(request_, found):
    family = SPACE | {"joints": {"pin": {"type": "revolute", "i": "a", "j": "ground"}}}
    if found is None:
        read("requests", family, e=request_)
    else:
        with pytest.raises(InputError, match=found):
            read("requests", family, e=request_)


@pytest.mark.parametrize(
    "section, entry, found",
    [
        ("forces", {"spring_law": {"table": [["-1 mm", "-3 N"], [0, 0], ["1 cm", "30 N"]]}}, None),
        ("forces", {"spring_law": {"table": [[-1e-3, -3], [0, 0], ["1 cm", 30]]}}, None),
        ("forces", {"spring_law": {"table": [["-1 kg", -3], [0, 0]]}}, "spring_law: found the table's arguments in kg, expected a length"),
        ("forces", {"spring_law": {"table": [[-1, "3 N m"], [0, 0]]}}, "spring_law: found the table's values in N m, expected a force"),
        ("forces", {"spring_law": {"table": [["-1 m", 3], ["1 s", 0]]}}, "spring_law.*: found m and s in one column of a table"),
        ("forces", {"damper_law": {"table": [["-1 m", 3], [0, 0]]}}, "the table's arguments in m, expected a velocity in m/s"),
        ("joints", {"velocity": {"table": [["0 s", 0], ["1 s", "300 rpm"]]}}, None),
        ("joints", {"velocity": {"table": [[0, 0], [1, "3 m/s"]]}}, "velocity: found the table's values in m/s, expected a velocity in rad/s"),
        ("joints", {"velocity": {"table": [[0, 0], ["1 m", 3]]}}, "the table's arguments in m, expected a time in s"),
    ],
)  # fmt: skip
def test_tables_with_units(section, entry, found):
    kinds = {"forces": {"type": "spring_damper", "i": "a", "j": "b"}, "joints": {"type": "drive", "joint": "pin"}}
    entries = {"e": kinds[section] | entry} | (
        {"pin": {"type": "revolute", "i": "a", "j": "ground"}} if section == "joints" else {}
    )
    if found is None:
        read(section, **entries)
    else:
        with pytest.raises(InputError, match=found):
            read(section, **entries)


@pytest.mark.parametrize(
    "formula, found",
    [
        ("pull(t)", None),
        ("2*pull(w*t)", None),
        ("pull(t - 1 s)", None),
        ("k*1 m + pull(t)", None),
        ("pull(a.x)", r"found m and s in 'pull\(a.x\)'"),
        ("pull(t)*a.x", "which is in N m, expected a force in N"),
        ("pull(t) + k", "found N and N/m"),
    ],
)
def test_named_tables_with_units(formula, found):
    family = PLANE | {"tables": {"pull": {"table": [["0 s", "1 N"], ["1 s", "3 N"]]}}}
    if found is None:
        read("forces", family, f=force(formula))
    else:
        with pytest.raises(InputError, match=found):
            read("forces", family, f=force(formula))


def test_a_model_in_python_is_as_careful():
    AppliedTorque(i="a", torque="3 N m*sin(t)")
    Drive(joint="pin", velocity="3 kg")  # whose joint is known in the model alone
    with pytest.raises(InputError, match="AppliedTorque: torque: found '5 N', which is in N, expected a torque in N m"):
        AppliedTorque(i="a", torque="5 N")
    with pytest.raises(InputError, match="LineForce: force: found N and m"):
        LineForce(i="a", j="b", force="3 N + dm(a, b)")


def test_parameters_keep_their_units_in_space():
    scene = stiffmbs.read_scene(
        json.dumps(PLANE | {"forces": {"f": force("k*0.3 m + 2*c*a.vx + F*sin(a.angle + 20 deg)")}})
    )
    assert in_space(scene).forces["f"].force[0].values["k"] == 5.0


def test_a_number_set_in_place_of_one_with_a_unit_has_that_unit(examples):
    expected = stiffmbs.load_scene(examples / "half_car.yaml")
    for k_b in ("1e7", "1e7 N/m", "1e4 N/mm"):
        found = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", k_b), ("parameters.V", "15")])
        for field in ("stiffness", "damping"):
            value, wanted = (getattr(each.forces["front_bushing"], field)[0][0] for each in (found, expected))
            assert value == pytest.approx(wanted, rel=1e-12)
    with pytest.raises(InputError, match="expected a stiffness in N/m"):
        stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e7 N")])


def test_only_counts_have_the_name_of_a_unit_in_the_examples():
    from ruamel.yaml import YAML

    for path in EXAMPLE_SCENES.values():
        named = set(YAML(typ="safe").load(path).get("parameters") or {}) & set(UNITS)
        assert named <= {"N"}, path.name


@pytest.mark.parametrize("formula", ["3 N/m*a.x", "m*9.81 m/s^2"])
def test_a_parameter_that_could_be_a_unit_is_to_be_renamed(formula):
    with pytest.raises(
        InputError, match=r"'m' in .*, which is a unit and a parameter of the scene, .*: rename the parameter"
    ):
        read("forces", PLANE | {"parameters": {"m": "2 kg"}}, f=force(formula))


@pytest.mark.parametrize(
    "text, dimension, value",
    [
        ("2 m^2^2/1 m^3", "length", 2.0),
        ("2 m^(4/2)/1 m", "length", 2.0),
        ("3 kg m s^-2", "force", 3.0),
        ("2 in", "length", 0.0508),
        ("(1 + 1) in", "length", 0.0508),
        ("1 g", "mass", 1e-3),
        ("1 g0", "acceleration", 9.80665),
        ("-1 kg*g0", "force", -9.80665),
        ("3000 rpm", "angular velocity", 100 * math.pi),
        ("50*2*pi*1 Hz", "angular velocity", 100 * math.pi),
        ("0.02/1 Hz", "time", 0.02),
        ("210 GPa", "pressure", 2.1e11),
        ("1 kgf", "force", 9.80665),
        ("1 slug*1 ft/s^2/1 lbf", "number", 1.0),
        ("1 psi*1 inch^2/1 lbf", "number", 1.0),
        ("2.4 bar/240 kPa", "number", 1.0),
        ("60 mph/1 km*1 h", "number", 96.56064),
    ],
)
def test_units(text, dimension, value):
    assert in_si(text, dimension) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("text", ["50 Hz", "1 kHz/2"])
def test_an_angular_velocity_is_not_in_hertz(text):
    with pytest.raises(FormulaError, match="which is 1/s, expected rad/s, rpm, or Hz times 2"):
        in_si(text, "angular velocity")


LEAVES = {"x": (0, 1, 0), "y": (0, 1, 0), "m": (1, 0, 0), "w": (0, 0, -1), "phi": (0, 0, 0)}
SIZES = {"x": 0.7, "y": 1.9, "m": 2.3, "w": 0.4, "phi": 0.6}
TREES = st.recursive(
    st.sampled_from([*LEAVES, "x", "y"]),
    lambda s: st.one_of(
        st.builds("({} {} {})".format, s, st.sampled_from("+-*/"), s),
        st.builds("({}*{}({}))".format, s, st.sampled_from(["sin", "atan", "exp", "sign"]), s),
        st.builds("{}({})".format, st.sampled_from(["sqrt", "abs"]), s),
        st.builds("{}({}, {})".format, st.sampled_from(["min", "max", "atan2"]), s, s),
        st.builds("({})^{}".format, s, st.sampled_from(["2", "3", "0.5"])),
        st.builds("2*{}".format, s),
        st.builds("step({}, {}, {}, {}, {})".format, s, s, s, s, s),
        st.builds("branch({}, {}, {}, {})".format, s, s, s, s),
    ),
    max_leaves=6,
)


def value_of(text, units):
    """A formula's value where the units of kg, m and s are so large."""
    names = {name: SIZES[name] * math.prod(u**p for u, p in zip(units, LEAVES[name], strict=True)) for name in LEAVES}
    return evaluate(parse(text), names.__getitem__, VALUES, float, OF_NUMBERS)


@pytest.mark.long
@settings(max_examples=300, suppress_health_check=[HealthCheck.too_slow])
@given(TREES)
def test_what_is_accepted_scales_as_its_dimension_says(text):
    """Bridgman, Dimensional Analysis (1922): a relation holds in all systems of units.

    Plain numbers, and what sin and the like make of them, are factors here: as terms of a sum they fit everything.
    """
    try:
        found = dimension_of(parse(text), lambda name: Quantity(SIZES[name], LEAVES[name]))
        in_si_units = value_of(text, (1, 1, 1))
    except (FormulaError, ArithmeticError, ValueError):
        return
    assume(found.exponents is not None and math.isfinite(in_si_units) and abs(in_si_units) > 1e-9)
    units = (1.7, 0.6, 2.5)
    scale = math.prod(u**p for u, p in zip(units, found.exponents, strict=True))
    assert value_of(text, units) == pytest.approx(in_si_units * scale, rel=1e-6)
