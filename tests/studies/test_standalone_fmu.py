"""FMUs without Python, simulated by FMPy, or by ctypes in a Python without any package."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import InputError
from stiffmbs.commands.main import main
from stiffmbs.studies.fmu.standalone import library
from stiffmbs.studies.fmu.standalone.library import own_platform
from stiffmbs.studies.fmu.standalone.model import exported_model
from tests.stress.fuzzers.fmu import has_compiler

read_model_description = pytest.importorskip("fmpy").read_model_description
if not has_compiler():
    pytest.skip("FMUs without Python need Linux and a C compiler", allow_module_level=True)

EXAMPLES = Path(__file__).parents[2] / "examples"
SCENE = """
name: Pushed
parameters: {k: 40 N/m}
inputs: {push: 0 N}
bodies: {sled: {mass: 2 kg, inertia: 0.1, velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: spring_damper, i: {body: sled, point: [0, 0]}, j: {body: ground, point: [-3, 0]}, stiffness: k, free_length: 3}
  pusher: {type: force, i: sled, force: [push, 0]}
run: {duration: 2 s, output: 10 ms, rtol: 1e-9}
"""
OMEGA = np.sqrt(40 / 2)

COMMON = """
import json, sys, threading
import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

path = sys.argv[1]
about = read_model_description(path)
refs = {v.name: v.valueReference for v in about.modelVariables}

def instance(folder=None, tolerance=None, **values):
    model = about.coSimulation.modelIdentifier
    made = FMU2Slave(guid=about.guid, unzipDirectory=folder or extract(path), modelIdentifier=model, instanceName="a")
    made.instantiate(loggingOn=True)
    made.setupExperiment(startTime=0.0, tolerance=tolerance)
    made.enterInitializationMode()
    for name, value in values.items():
        made.setReal([refs[name]], [value])
    made.exitInitializationMode()
    return made

def values(made, *names):
    return made.getReal([refs[name] for name in names])

def refused(call, *values):
    try:
        call(*values)
    except Exception:
        return True
    return False
"""


def told_by(script, *arguments):
    """What a script prints last, in a process of its own that does not import the package."""
    text = f"{COMMON}\n{script}\nassert 'stiffmbs' not in sys.modules"
    command = [sys.executable, "-c", text, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:] + done.stdout[-2000:]
    return json.loads(done.stdout.splitlines()[-1]), done.stdout + done.stderr


@pytest.fixture
def built(tmp_path):
    """Function that writes the FMU of a scene's text."""

    def built_of(text=SCENE, outputs=(), **given):
        (tmp_path / "pushed.yaml").write_text(text, encoding="utf-8")
        stiffmbs.build_fmu(tmp_path / "pushed.yaml", tmp_path / "pushed.fmu", outputs, native=True, **given)
        return tmp_path / "pushed.fmu"

    return built_of


SIMULATED = """
found = simulate_fmu(path, fmi_type=sys.argv[2], stop_time=float(sys.argv[3]), output_interval=float(sys.argv[4]), solver="CVode", relative_tolerance=1e-11)
names = json.loads(sys.argv[5])
kept = np.r_[np.diff(found["time"]) > 1e-9, True]  # the values before an event
print(json.dumps([validate_fmu(path), found["time"][kept].tolist(), [found[name][kept].tolist() for name in names]]))
"""


@pytest.mark.filterwarnings("ignore:the scene is stiff")
@pytest.mark.parametrize(
    ("name", "kind", "bound", "version"),
    [
        ("cart_pendulum", "CoSimulation", 1e-10, "2.0"), ("cart_pendulum", "ModelExchange", 1e-7, "2.0"),
        ("half_car", "CoSimulation", 1e-8, "2.0"), ("half_car", "ModelExchange", 1e-6, "2.0"),
        ("bouncing_ball", "CoSimulation", 1e-6, "2.0"), ("bouncing_ball", "ModelExchange", 1e-5, "2.0"),
        ("stick_slip", "CoSimulation", 1e-6, "2.0"), ("stick_slip", "ModelExchange", 1e-5, "2.0"),
        ("heavy_top", "CoSimulation", 1e-9, "2.0"), ("half_car", "CoSimulation", 1e-8, "3.0"), ("half_car", "ModelExchange", 1e-6, "3.0"),
        ("bouncing_ball", "CoSimulation", 1e-6, "3.0"), ("bouncing_ball", "ModelExchange", 1e-5, "3.0"),
    ],
)  # fmt: skip
def test_an_fmu_moves_as_a_run_does(tmp_path, name, kind, bound, version):
    """All channels that it has: motions, reactions, energies; with breakpoints of inputs, impacts, and dry friction."""
    fmu, scene = tmp_path / "a.fmu", EXAMPLES / f"{name}.yaml"
    channels = stiffmbs.build_fmu(scene, fmu, native=True, version=version)
    run = stiffmbs.run(scene, solver="projected", rtol=1e-12)
    step = float(run.t[1] - run.t[0])
    (faults, times, found), _ = told_by(SIMULATED, fmu, kind, run.t[-1], step, json.dumps(channels))
    assert faults == []
    at = np.searchsorted(times, run.t - 1e-6 * step)
    np.testing.assert_allclose(np.array(times)[at], run.t, atol=1e-7)
    for channel, values in zip(channels, found, strict=True):
        size = max(1.0, np.abs(run[channel]).max())
        assert np.abs(np.array(values)[at] - run[channel]).max() <= bound * size, channel


MEASURED = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {g: 3}
bodies:
  bar: {mass: 2, inertia: [0.1, 0.2, 0.2], position: [0.5, 0, 0], omega: [0, 0, 25], markers: {end: {point: [0.5, 0, 0]}}}
joints: {pin: {type: spherical, i: {body: bar, point: [-0.5, 0, 0]}, j: ground}}
requests:
  turned: az(bar)
  tip: {along: "dx(bar.end)", speed: g*vm(bar.end)^2, high: "max(dz(bar.end), 0)"}
  pull: fm(pin)
run: {duration: 1 s, output: 10 ms, rtol: 1e-9}
"""


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_requests_of_positions_and_velocities_are_outputs(tmp_path, kind):
    """The bar turns more than once. Requests that Python computes are left out with a note."""
    scene, fmu = tmp_path / "bar.yaml", tmp_path / "bar.fmu"
    scene.write_text(MEASURED, encoding="utf-8")
    with pytest.warns(RuntimeWarning, match="are computed by Python, and no outputs: pull"):
        channels = stiffmbs.build_fmu(scene, fmu, native=True)
    assert channels == ("turned", "tip.along", "tip.speed", "tip.high")
    (faults, times, found), _ = told_by(SIMULATED, fmu, kind, 1.0, 0.01, json.dumps(channels))
    run = stiffmbs.run(scene, solver="projected", rtol=1e-12)
    assert faults == [] and run["turned"][-1] > 2 * np.pi
    at = np.searchsorted(times, run.t - 1e-8)
    for channel, values in zip(channels, found, strict=True):
        size = max(1.0, np.abs(run[channel]).max())
        assert np.abs(np.array(values)[at] - run[channel]).max() <= 1e-6 * size, channel


def test_requests_that_are_no_outputs_have_no_effect(tmp_path):
    """A formula of time is known up to the end of the run; with one, steps beyond it are refused."""
    scene = tmp_path / "bar.yaml"
    scene.write_text(MEASURED.replace("pull: fm(pin)", "pull: sin(1000*t)"), encoding="utf-8")
    data = stiffmbs.load_scene(scene)
    assert exported_model(data).depends_on_time
    assert not exported_model(data, ["bar.x", "turned"]).depends_on_time


ALONE = """
import ctypes, json, sys
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
assert not any("site-packages" in path for path in sys.path)
library, token, refs = ctypes.CDLL(sys.argv[1]), sys.argv[2].encode(), json.loads(sys.argv[3])
library.fmi2Instantiate.restype = c_void_p
made = c_void_p(library.fmi2Instantiate(b"a", 1, token, b"", None, 0, 0))
assert made.value
no = c_double(0.0)
library.fmi2SetupExperiment(made, 0, no, no, 0, no)
library.fmi2EnterInitializationMode(made), library.fmi2ExitInitializationMode(made)
status = [library.fmi2DoStep(made, c_double(0.1 * k), c_double(0.1), 1) for k in range(10)]
found = (c_double * len(refs))()
status.append(library.fmi2GetReal(made, (c_uint * len(refs))(*refs), c_size_t(len(refs)), found))
library.fmi2FreeInstance(made)
print(json.dumps([status, list(found)]))
"""


def test_an_fmu_needs_no_package(built, tmp_path):
    """Python without site-packages loads the library; its wrong GUID gives no instance."""
    import fmpy

    fmu = built(outputs=["sled.x", "sled.vx"])
    about = fmpy.read_model_description(str(fmu))
    folder = Path(fmpy.extract(str(fmu), str(tmp_path / "fmu")))
    refs = [next(v.valueReference for v in about.modelVariables if v.name == name) for name in ("sled.x", "sled.vx")]
    file = folder / "binaries" / own_platform().folders["2.0"] / "pushed.so"
    command = [sys.executable, "-I", "-S", "-c", ALONE, str(file), about.guid, json.dumps(refs)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, env={})
    status, found = json.loads(done.stdout)
    assert status == [0] * 11
    np.testing.assert_allclose(found, [np.sin(OMEGA) / OMEGA, np.cos(OMEGA)], atol=1e-7)
    refused = subprocess.run([*command[:-2], "{other}", "[]"], capture_output=True, text=True, timeout=100, env={})
    assert "AssertionError" in refused.stderr
    with zipfile.ZipFile(fmu) as archive:
        assert "Modelica Association" in archive.read("documentation/licenses/notices.txt").decode()


PUSHED = """
made = instance(push=3.0)
rows = [values(made, "sled.x", "push", "pusher.fx", "rail.fy", "energy.total")]
for k in range(200):
    made.setReal([refs["push"]], [8.0 if k >= 50 else 0.0])
    if k == 50:
        jumped = values(made, "sled.x", "sled.ax")
    made.doStep(0.01 * k, 0.01)
    rows.append(values(made, "sled.x", "push", "pusher.fx", "rail.fy", "energy.total"))
faults = [refused(made.doStep, 3.0, 0.1), refused(made.setReal, [refs["push"]], [float("nan")]), refused(made.setReal, [refs["rail.fy"]], [1.0])]
print(json.dumps([rows, jumped, faults]))
"""


def test_inputs_act_from_the_time_they_are_set(built):
    """By the closed form of the oscillator: an input at the start, then none, then another one."""
    (rows, jumped, faults), said = told_by(PUSHED, built())
    x, push, force, _, _ = np.array(rows).T
    t = 0.01 * np.arange(201)
    late = np.maximum(t - 0.5, 0)
    np.testing.assert_allclose(x, np.sin(OMEGA * t) / OMEGA + 8 / 40 * (1 - np.cos(OMEGA * late)), atol=1e-6)
    assert push[0] == 3.0 and force[0] == 3.0 and push[-1] == force[-1] == 8.0
    assert jumped[1] == pytest.approx((8 - 40 * jumped[0]) / 2, abs=1e-9)
    assert faults == [True] * 3
    assert "a step does not begin where the last one ended" in said and "a value is not finite" in said


STATES = """
one = instance(push=2.0)
names = "sled.x", "sled.vx", "rail.fy", "energy.total"
step = lambda made, first, last: [made.doStep(0.01 * k, 0.01) for k in range(first, last)] and values(made, *names)
step(one, 0, 30)
kept = one.getFMUstate()
data = one.serializeFMUstate(kept)
at, ends = values(one, *names), [step(one, 30, 60)]
one.setReal([refs["push"]], [50.0])
step(one, 60, 70)
one.setFMUstate(kept)
back = values(one, *names), values(one, "push")
ends.append(step(one, 30, 60))
other = instance()
other.setFMUstate(other.deSerializeFMUstate(data))
ends.append(step(other, 30, 60))
faults = [refused(other.deSerializeFMUstate, data[:-1]), refused(other.deSerializeFMUstate, b"x" + data[1:])]
one.freeFMUstate(kept)
one.reset()
one.setupExperiment(startTime=0.0)
one.enterInitializationMode()
one.setReal([refs["push"]], [2.0])
one.exitInitializationMode()
step(one, 0, 30)
print(json.dumps([at, back, ends, faults, values(one, *names)]))
"""


TUNED = """
name: Tuned
parameters: {k: 40 N/m, c: 2*k*0.01 s, m: 2 kg, F: 3 N, both: 2, start: 0.1, w: 4, p: 1, r: 2}
inputs: {push: 0 N}
bodies: {sled: {mass: m, inertia: 0.1, position: [start, 0], velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: spring_damper, i: sled, j: {body: ground, point: [-3, 0]}, stiffness: k, damping: 0.3, free_length: 3}
  pull: {type: force, i: sled, force: ["F*(1 - sled.x/1 m)", 0]}
  swing: {type: force, i: sled, force: ["0.5*sin(w*t)", 0]}
  pusher: {type: force, i: sled, force: ["both*push", 0]}
  product: {type: force, i: sled, force: ["p*r*0.1 N", 0]}
run: {duration: 2 s, output: 20 ms, rtol: 1e-9}
"""


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_parameters_of_forces_are_tunable(tmp_path, version):
    """Others are fixed: those of bodies and of the start, in functions of time, and of a product all but the first."""
    path = tmp_path / "tuned.yaml"
    path.write_text(TUNED)
    stiffmbs.build_fmu(path, tmp_path / "tuned.fmu", ["sled.x", "energy.total"], native=True, version=version)
    script = """
from fmpy import simulate_fmu
tuned = {v.name: (v.variability, v.initial, float(v.start)) for v in about.modelVariables if v.causality == 'parameter'}
found = [
    simulate_fmu(path, start_values=given, fmi_type=kind, output=['sled.x', 'energy.total'], stop_time=2.0, output_interval=0.02, relative_tolerance=1e-9)
    for kind in ('CoSimulation', 'ModelExchange') for given in ({}, {'k': 90.0, 'F': -7.0, 'both': 3.0, 'push': 2.0, 'p': 40.0})
]
print(json.dumps([tuned, [[list(map(float, r[n])) for n in ('sled.x', 'energy.total')] for r in found]]))
"""
    (tuned, found), _ = told_by(script, tmp_path / "tuned.fmu")
    assert tuned == {name: ["tunable", "exact", value] for name, value in {"k": 40, "F": 3, "both": 2, "p": 1}.items()}
    changed = [("k", "90"), ("F", "-7"), ("both", "3"), ("inputs.push", "2"), ("p", "40")]
    runs = [stiffmbs.run(stiffmbs.load_scene(path, changes=given), rtol=1e-10) for given in ([], changed)] * 2
    for (x, energy), run in zip(found, runs, strict=True):
        assert np.abs(np.array(x) - run["sled.x"]).max() < 1e-6
        assert np.abs(np.array(energy) - run["energy.total"]).max() < 1e-5


def test_a_parameter_acts_from_the_time_it_is_set(tmp_path):
    path = tmp_path / "tuned.yaml"
    path.write_text(
        TUNED.replace("0.3,", "0,").replace("F: 3 N", "F: 0 N").replace("0.5*sin", "0*sin").replace("p: 1", "p: 0")
    )
    stiffmbs.build_fmu(path, tmp_path / "tuned.fmu", ["sled.x"], native=True)
    script = """
made = instance(tolerance=1e-9)
made.doStep(0.0, 0.5)
made.setReal([refs['k']], [160.0])
made.doStep(0.5, 0.5)
print(json.dumps(values(made, 'sled.x', 'k')))
"""
    (x, k), _ = told_by(script, tmp_path / "tuned.fmu")
    first, then = np.sqrt(40 / 2), np.sqrt(160 / 2)
    place = 0.1 * np.cos(first * 0.5) + np.sin(first * 0.5) / first
    velocity = -0.1 * first * np.sin(first * 0.5) + np.cos(first * 0.5)
    assert (x, k) == (pytest.approx(place * np.cos(then * 0.5) + velocity / then * np.sin(then * 0.5), abs=1e-7), 160.0)


@pytest.mark.parametrize(
    "start", ["start: settled", "at_start: {begin: {type: drive, joint: rail, velocity: p*50 cm/s}}"]
)
def test_parameters_of_a_computed_start_are_fixed(tmp_path, start):
    path = tmp_path / "tuned.yaml"
    path.write_text(f"{TUNED}{start}\n")
    assert exported_model(stiffmbs.load_scene(path)).parameters == ()


def test_steps_from_a_restored_state_are_equal_to_the_last_bit(built):
    (at, back, ends, faults, reset), _ = told_by(STATES, built())
    assert back == [at, [2.0]]
    assert ends[0] == ends[1] == ends[2]
    assert faults == [True, True] and reset == at


THREADS = """
folder = extract(path)
found = {}
def run(number):
    made = instance(folder, 1e-10)
    found[number] = [made.doStep(0.01 * k, 0.01) or values(made, *sys.argv[2].split(",")) for k in range(100)]
    made.freeInstance()
run(0)
threads = [threading.Thread(target=run, args=(k,)) for k in range(1, 7)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
print(json.dumps([len(found), all(found[k] == found[0] for k in found)]))
"""


def test_instances_in_threads_are_equal_to_the_last_bit(tmp_path):
    stiffmbs.build_fmu(EXAMPLES / "bouncing_ball.yaml", tmp_path / "a.fmu", native=True)
    assert told_by(THREADS, tmp_path / "a.fmu", "ball.y,ball.vy")[0] == [7, True]


def test_two_of_one_scene_are_equal_to_the_last_byte(built):
    """With other parameters of the integrator, the code is another one."""
    first = built().read_bytes()
    assert built().read_bytes() == first
    assert built(SCENE.replace("rtol:", "tuning: {explicit_steps: {safety: 0.5}}, rtol:")).read_bytes() != first


def test_formulas_of_time_are_known_for_the_run_alone(built):
    fmu = built(SCENE.replace("[push, 0]", "['push + 2 N*(1 + sign(t - 0.7 s))', 0]"))
    script = """
made = instance()
late = refused(made.doStep, 0.0, 2.5)
made = instance()
made.doStep(0.0, 0.7)
at = values(made, "pusher.fx")
made.doStep(0.7, 1e-9)
other = FMU2Slave(guid=about.guid, unzipDirectory=extract(path), modelIdentifier="pushed", instanceName="b")
other.instantiate(loggingOn=True)
print(json.dumps([late, at, values(made, "pusher.fx"), refused(other.setupExperiment, None, 1.0)]))
"""
    found, said = told_by(script, fmu)
    assert found == [True, [0.0], [4.0], True]
    assert "up to the stop time" in said and "for the start time of the scene" in said


def test_a_motion_without_formulas_of_time_may_go_on(built):
    """Beyond the run of the scene, and from another time; a formula of the motion is none of time."""
    fmu = built(SCENE.replace("[push, 0]", "[push - 3*sled.vx*abs(sled.vx), 0]"))
    script = """
made = FMU2Slave(guid=about.guid, unzipDirectory=extract(path), modelIdentifier="pushed", instanceName="a")
made.instantiate(loggingOn=True)
made.setupExperiment(startTime=5.0)
made.enterInitializationMode()
made.exitInitializationMode()
made.doStep(5.0, 2.5)
print(json.dumps(values(made, "sled.x", "sled.vx")))
"""
    run = stiffmbs.run(stiffmbs.load_scene(fmu.with_suffix(".yaml")), duration=2.5, points=3, rtol=1e-11)
    assert told_by(script, fmu)[0] == pytest.approx([run["sled.x"][-1], run["sled.vx"][-1]], abs=1e-7)


def test_a_force_that_chatters_ends_a_step(built):
    """A sled that a relay brings to rest; the step before is not affected."""
    fmu = built(SCENE.replace("[push, 0]", "[-20 N*sign(sled.vx) + push, 0]"))
    script = """
made = instance()
made.doStep(0.0, 0.01)
print(json.dumps([refused(made.doStep, 0.01, 1.0), values(made, "sled.vx")]))
"""
    (ended, (speed,)), said = told_by(script, fmu)
    assert ended and abs(speed) < 1e-6 and "a force chatters" in said


def test_a_start_may_be_set(built):
    """States of a pendulum are brought to the nearest ones that satisfy its joint."""
    text = "bodies: {bar: {mass: 1, inertia: 0.1, position: [1, 0]}}\njoints: {pin: {type: revolute, i: {body: bar, point: [-1, 0]}, j: ground}}"
    script = """
made = instance(**{"bar.x": 0.0, "bar.y": -1.1, "bar.angle": -1.5})
made.doStep(0.0, 0.1)
print(json.dumps(values(made, "bar.x", "bar.y", "bar.angle", "constraint.position")))
"""
    (x, y, angle, open_), _ = told_by(script, built(text))
    assert open_ < 1e-11 and (x, y) == pytest.approx((np.cos(angle), np.sin(angle)), abs=1e-11)
    assert angle == pytest.approx(-np.pi / 2, abs=0.1)


IN_VERSION_3 = """
from fmpy.fmi3 import FMU3Slave
told = []
made = FMU3Slave(guid=about.guid, unzipDirectory=extract(path), modelIdentifier="pushed", instanceName="a")
made.instantiate(logMessage=None)
made.enterInitializationMode(startTime=0.0)
made.setFloat64([refs["push"]], [2.0])
made.exitInitializationMode()
step = lambda first, last: [made.doStep(0.01 * k, 0.01) for k in range(first, last)] and made.getFloat64([refs["sled.x"], refs["time"]])
step(0, 50)
kept = made.getFMUState()
data = made.serializeFMUState(kept)
ends = [step(50, 100)]
made.setFMUState(made.deserializeFMUState(data))
ends.append(step(50, 100))
print(json.dumps([ends, refused(made.doStep, 3.0, 0.1), refused(made.getInt32, [0])]))
"""


def test_fmi_3_has_the_same_states_and_refusals(built):
    ((first, again), *faults), _ = told_by(IN_VERSION_3, built(version="3.0"))
    assert first == again and faults == [True, True]
    assert first == pytest.approx([np.sin(OMEGA) / OMEGA + 2 / 40 * (1 - np.cos(OMEGA)), 1.0], abs=1e-7)


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_variables_have_units(tmp_path, version):
    (tmp_path / "pushed.yaml").write_text(SCENE + "requests: {where: dx(sled)}\n")
    chosen = ["where", "sled.angle", "sled.omega", "rail.fy", "energy.total", "constraint.position"]
    stiffmbs.build_fmu(tmp_path / "pushed.yaml", tmp_path / "a.fmu", chosen, native=True, version=version)
    about = read_model_description(str(tmp_path / "a.fmu"), validate=True)
    found = {variable.name: variable.unit for variable in about.modelVariables if variable.name in chosen}
    assert found == dict(zip(chosen, ("m", "rad", "rad/s", "N", "J", None), strict=True))
    powers = {unit.name: unit.baseUnit for unit in about.unitDefinitions}
    assert (powers["J"].kg, powers["J"].m, powers["J"].s, powers["rad/s"].rad, powers["rad/s"].s) == (1, 2, -2, 1, -1)


def test_versions_are_2_and_3(built, tmp_path):
    with pytest.raises(InputError, match=r"version: found '1\.0', expected 2\.0 or 3\.0"):
        built(version="1.0")
    with pytest.raises(InputError, match=r"found '3\.0', expected 2\.0, or an FMU without Python"):
        stiffmbs.build_fmu(tmp_path / "pushed.yaml", tmp_path / "a.fmu", version="3.0")


REQUESTS = SCENE + "requests: {where: 2*rail.fy}\n"
REFUSED = {
    "requests": (REQUESTS, (), "the output 'where' is computed by Python; choose others by --channel"),
    "unknown": (SCENE, ("sled.q",), "found no channel 'sled.q'"),
    "an input": (SCENE, ("push",), "found the output 'push', which is an input"),
    "sampled": (SCENE + "states: {held: {update: sled.x, period: 0.1}}\n", (), "it has sampled states"),
    "moved breakpoints": (SCENE.replace("[push, 0]", "['sign(t - push)', 0]").replace("push: 0 N", "push: 0"), (), "its inputs change the times"),
    "kinematic": (SCENE.replace("rtol:", "solver: kinematic, rtol:"), (), "'kinematic' is no integrator"),
    "fixed steps": (SCENE.replace("rtol:", "solver: projected, step: 1 ms, rtol:"), (), "its scheme has fixed steps"),
    "stiff": (SCENE.replace("k: 40 N/m", "k: 4e20 N/m"), (), "explicit steps of .* s would take more than ten minutes"),
    "table": (
        SCENE.replace("[push, 0]", "[push + T(sled.x), 0]") + "tables: {T: {table: [[-1, 0], [1, 1]], beyond: error}}\n", (), "a table has 'beyond: error'",
    ),
    "end": (SCENE.replace("[push, 0]", "['1/(t - 1)', 0]"), (), "a formula of time has no value"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_needs_python_is_refused_in_a_sentence(built, case):
    text, outputs, words = REFUSED[case]
    with pytest.raises(InputError, match=words):
        built(text, outputs)


def test_without_a_compiler_the_extra_is_named(built, monkeypatch):
    monkeypatch.setattr(library, "COMPILERS", ())
    monkeypatch.setattr(library.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"needs a C compiler.*pip install 'stiffmbs\[fmu\]'"):
        built()


def test_faults_of_the_compiler_and_other_platforms_are_told(built, monkeypatch):
    monkeypatch.setattr(library, "OPTIONS", ("-fno-such-option",))
    with pytest.raises(InputError, match=r"the C compiler .* failed"):
        built()
    monkeypatch.setattr(library.platform, "machine", lambda: "riscv64")
    with pytest.raises(InputError, match="made on Linux with x86-64 processors"):
        built()


def test_the_command_writes_and_notes(tmp_path):
    output = tmp_path / "a.fmu"
    command = ["fmu", str(EXAMPLES / "half_car.yaml"), "-o", str(output), "--native", "--channel", "chassis.y"]
    found = CliRunner().invoke(main, [*command, "--set", "k_b=2e7"])
    assert found.exit_code == 0 and "1 outputs" in found.output and "note: the scene is stiff" in found.output
    found = CliRunner().invoke(main, [*command, "--json"])
    assert json.loads(found.stdout)["outputs"] == ["chassis.y"] and "stiff" in json.loads(found.stdout)["notes"][0]
    with pytest.warns(RuntimeWarning, match="stability limits the steps of co-simulation"):
        stiffmbs.build_fmu(EXAMPLES / "half_car.yaml", output, native=True)
