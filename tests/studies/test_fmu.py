"""Scenes as FMUs, run by FMPy in a process of its own: an FMU brings its own Python into the program that runs it."""

import json
import shutil
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

EXAMPLES = Path(__file__).parents[2] / "examples"

read_model_description = pytest.importorskip("fmpy").read_model_description
pytest.importorskip("pythonfmu")

SCENE = """
name: Pushed
parameters: {k: 40 N/m}
inputs: {push: 0 N}
bodies: {sled: {mass: 2 kg, inertia: 0.1, velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: spring_damper, i: {body: sled, point: [0, 0]}, j: {body: ground, point: [-3, 0]}, stiffness: k, free_length: 3}
  pusher: {type: force, i: sled, force: [push, 0]}
requests: {where: sled.x, speed: sled.vx}
run: {duration: 2 s, output: 10 ms, rtol: 1e-9}
"""

RUN = """
import json, sys
import numpy as np
from fmpy import simulate_fmu
path, values, pushes = sys.argv[1], json.loads(sys.argv[2]), json.loads(sys.argv[3])
signals = np.array([tuple(row) for row in pushes], dtype=[("time", float), ("push", float)]) if pushes else None
found = simulate_fmu(path, stop_time=2.0, step_size=0.01, output_interval=0.01, start_values=values, input=signals)
print(json.dumps({name: found[name].tolist() for name in found.dtype.names}))
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "pushed.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def simulated(fmu, values=None, pushes=()):
    command = [sys.executable, "-c", RUN, str(fmu), json.dumps(values or {}), json.dumps(list(pushes))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    return {name: np.array(found) for name, found in json.loads(done.stdout.splitlines()[-1]).items()}


@pytest.mark.long
def test_an_fmu_moves_as_the_run_does(scene, tmp_path):
    """Free, with another parameter, and pushed from 0.5 s on: by the closed form of the oscillator."""
    fmu = tmp_path / "pushed.fmu"
    assert stiffmbs.build_fmu(scene, fmu) == ("where", "speed")
    omega = np.sqrt(90 / 2)
    stiffer = simulated(fmu, {"k": 90.0})
    np.testing.assert_allclose(stiffer["where"], np.sin(omega * stiffer["time"]) / omega, atol=1e-6)
    np.testing.assert_allclose(
        stiffer["where"][-1], stiffmbs.run(stiffmbs.load_scene(scene, [("k", "90 N/m")]))["where"][-1], atol=1e-6
    )

    pushed = simulated(fmu, pushes=[(0.0, 0.0), (0.5, 0.0), (0.5, 8.0), (2.0, 8.0)])
    omega = np.sqrt(40 / 2)
    late = np.maximum(pushed["time"] - 0.5, 0)
    x = np.sin(omega * pushed["time"]) / omega + 8 / 40 * (1 - np.cos(omega * late))
    np.testing.assert_allclose(pushed["where"], x, atol=1e-6)


def test_the_command_names_the_outputs(scene, tmp_path):
    found = CliRunner().invoke(
        main, ["fmu", str(scene), "-o", str(tmp_path / "a.fmu"), "--channel", "rail.fy", "--json"]
    )
    assert found.exit_code == 0, found.output
    assert json.loads(found.output)["outputs"] == ["rail.fy"]


@pytest.mark.parametrize(
    ("output", "channels", "words"),
    [
        ("a.zip", (), "found the ending '.zip', expected .fmu"),
        ("a.fmu", ("sled.q",), "found no channel 'sled.q'"),
        ("a.fmu", "sled.x", "outputs: found 'sled.x', expected a list of channels"),
        ("a.fmu", ("push",), "which is an input or parameter"),
    ],
)
def test_what_cannot_be_built_is_told(scene, tmp_path, output, channels, words):
    with pytest.raises(InputError, match=words):
        stiffmbs.build_fmu(scene, tmp_path / output, channels)


INSTANCES = """
import json, sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

def instance(folder, path, k):
    about = read_model_description(path)
    model = about.coSimulation.modelIdentifier
    made = FMU2Slave(guid=about.guid, unzipDirectory=folder, modelIdentifier=model, instanceName=f"instance{k}")
    made.instantiate()
    return made, {v.name: v.valueReference for v in about.modelVariables}

def started(made, refs, k):
    made.setupExperiment(startTime=0.0)
    made.enterInitializationMode()
    made.setReal([refs["k"]], [40.0 + 10 * k])
    at_start = made.getReal([refs["pull"]])
    made.exitInitializationMode()
    assert made.getReal([refs["pull"]]) == at_start, (made.getReal([refs["pull"]]), at_start)

paths, freed = sys.argv[1].split(","), sys.argv[2] == "freed"
folders = [extract(path) for path in paths]
instances = [instance(folders[k % len(paths)], paths[k % len(paths)], k) for k in range(6)]
if freed:
    for made, _ in instances[::2]:
        made.freeInstance()
    instances[::2] = [instance(folders[k % len(paths)], paths[k % len(paths)], k) for k in range(0, 6, 2)]
for k, (made, refs) in enumerate(instances):
    started(made, refs, k)
for step in range(50):
    for made, _ in instances:
        made.doStep(0.01 * step, 0.01)
print(json.dumps([made.getReal([refs["where"]])[0] for made, refs in instances]))
for made, _ in instances:
    made.terminate()
    made.freeInstance()
"""


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(("files", "freed"), [(1, "freed"), (3, "kept"), (3, "freed")])
def test_a_process_may_have_many_instances_of_one_or_several_files(tmp_path, files, freed):
    paths = [tmp_path / f"sled{k}.fmu" for k in range(files)]
    for k, path in enumerate(paths):
        (tmp_path / f"sled{k % 2}.yaml").write_text(SCENE.replace("where: sled.x", "where: sled.x, pull: spring.fx"))
        stiffmbs.build_fmu(tmp_path / f"sled{k % 2}.yaml", path, ["where", "pull"])  # two of three have one name
    command = [sys.executable, "-c", INSTANCES, ",".join(map(str, paths)), freed]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    omega = np.sqrt((40 + 10 * np.arange(6)) / 2)
    np.testing.assert_allclose(json.loads(done.stdout.splitlines()[-1]), np.sin(omega * 0.5) / omega, atol=1e-7)


SPACE = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {k: 40 N/m}
bodies: {ball: {mass: 1, inertia: [1, 1, 1], position: [0.3, 0, 0]}}
forces: {spring: {type: force, i: ball, force: [-k*ball.x, 0, 9.81 N]}}
"""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("text", "outputs"),
    [
        (SCENE, ()), (SCENE, ("sled.x",)), (SCENE.replace("requests:", "# "), ()), (SCENE.replace("inputs: {push: 0 N}", "variables: {push: 0 N}"), ()),
        (SCENE.replace("k: 40 N/m", "k: 40 N/m, other: 3, third: 2 m"), ()), (SPACE, ()), (SPACE, ("ball.vx", "spring.fx")),
        (SCENE.replace("name: Pushed", r'name: "a <b> & \x9b \"c\" \u202e \ufffe"'), ()),
    ],
)  # fmt: skip
def test_the_model_description_is_valid(tmp_path, text, outputs):
    from fmpy.validation import validate_fmu

    (tmp_path / "model.yaml").write_text(text, encoding="utf-8")
    stiffmbs.build_fmu(tmp_path / "model.yaml", tmp_path / "model.fmu", outputs)
    assert validate_fmu(str(tmp_path / "model.fmu")) == []


NAMES = (
    "class", "a b", "1st", "-x", "ünïcode", "日本", "SceneSlave", "hold", "...", "x" * 200, "a'b\"c", "a\nb", "None", "\u202ex", "import.os",
)  # fmt: skip
STARTS = """
import json, os, sys
from fmpy import simulate_fmu
print(json.dumps([float(simulate_fmu(path, stop_time=0.01, step_size=0.01)["where"][0]) for path in sys.argv[1:]]), flush=True)
os._exit(0)  # at exit, PythonFMU 0.7.0 deletes a static object after its destructor: "free(): corrupted unsorted chunks"
"""


@pytest.mark.long
def test_a_scene_may_have_any_name(tmp_path):
    paths = [tmp_path / f"x{k}.fmu" for k in range(len(NAMES))]
    for k, (name, path) in enumerate(zip(NAMES, paths, strict=True)):
        scene = tmp_path / f"{name}.yaml"
        scene.write_text(
            SCENE.replace("[-3, 0]", f"[{-3 - k}, 0]").replace(
                "requests: {where: sled.x", f"requests: {{where: sled.x + {k}"
            )
        )
        stiffmbs.build_fmu(scene, path)
    done = subprocess.run([sys.executable, "-c", STARTS, *map(str, paths)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    np.testing.assert_allclose(json.loads(done.stdout.splitlines()[-1]), range(len(NAMES)), atol=1e-12)


STATES = """
import json, sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

path = sys.argv[1]
about, folder = read_model_description(path), extract(path)
refs = {v.name: v.valueReference for v in about.modelVariables}

def instance(**values):
    made = FMU2Slave(guid=about.guid, unzipDirectory=folder, modelIdentifier=about.coSimulation.modelIdentifier, instanceName="a")
    made.instantiate(loggingOn=True)
    made.setupExperiment(startTime=0.0)
    made.enterInitializationMode()
    for name, value in values.items():
        made.setReal([refs[name]], [value])
    made.exitInitializationMode()
    return made

def where(made):
    return made.getReal([refs["where"], refs["speed"], refs["push"]])

def refused(call, *values):
    try:
        call(*values)
    except Exception:
        return True
    return False

one = instance(k=90.0)
one.setReal([refs["push"]], [5.0])
one.doStep(0.0, 0.25)
kept = one.getFMUstate()
as_bytes = one.serializeFMUstate(kept)
at = where(one)
one.setReal([refs["push"]], [-50.0])
one.doStep(0.25, 0.25)
one.setFMUstate(kept)
back = where(one)
one.doStep(0.25, 0.25)
first = where(one)
other = instance()
other.setFMUstate(other.deSerializeFMUstate(as_bytes))
other.doStep(0.25, 0.25)
faults = [refused(other.setReal, [refs["k"]], [40.0]), refused(other.doStep, 3.0, 0.1), refused(other.doStep, 0.25, 0.1)]
again = where(other)
other.reset()
other.setupExperiment(startTime=0.0)
other.enterInitializationMode()
other.setReal([refs["k"], refs["push"]], [90.0, 5.0])
other.exitInitializationMode()
other.doStep(0.0, 0.25)
print(json.dumps([at, back, first, again, faults, where(other)]))
"""


@pytest.mark.long
def test_states_are_kept_and_late_parameters_and_wrong_times_are_refused(scene, tmp_path):
    stiffmbs.build_fmu(scene, tmp_path / "pushed.fmu")
    done = subprocess.run(
        [sys.executable, "-c", STATES, str(tmp_path / "pushed.fmu")], capture_output=True, text=True, timeout=300
    )
    at, back, first, again, faults, reset = json.loads(done.stdout.splitlines()[-1])
    omega = np.sqrt(90 / 2)

    def exact(t):
        moved = np.sin(omega * t) / omega + 5 / 90 * (1 - np.cos(omega * t))
        return [moved, np.cos(omega * t) + 5 / 90 * omega * np.sin(omega * t), 5.0]

    for found, t in ((at, 0.25), (back, 0.25), (first, 0.5), (again, 0.5), (reset, 0.25)):
        assert found == pytest.approx(exact(t), abs=1e-6)
    assert faults == [True, True, True]
    assert "parameter 'k': found 40 after the start" in done.stdout + done.stderr
    assert "found a step from 3 s, expected one from 0.5 s" in done.stdout + done.stderr


@pytest.fixture
def slave(scene, tmp_path, monkeypatch):
    """Return a function that makes an FMU of changed text, and its slave without the simulating program."""
    from stiffmbs.studies.fmu import slave as module

    made = []
    monkeypatch.setattr(module, "simulation", lambda model: made.append(stiffmbs.simulation(model)) or made[-1])

    def slave_of(text, outputs):
        scene.write_text(text, encoding="utf-8")
        stiffmbs.build_fmu(scene, tmp_path / "a.fmu", outputs)
        with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
            archive.extractall(tmp_path / "fmu")
        return module.SceneSlave(instance_name="one", resources=str(tmp_path / "fmu/resources"))

    slave_of.made = made
    return slave_of


def put(slave, **values):
    for name, value in values.items():
        next(v for v in slave.vars.values() if v.name == name).setter(value)


def value_of(slave, name):
    return next(v for v in slave.vars.values() if v.name == name).getter()


def test_an_input_of_an_fmu_returns_to_its_first_value(slave):
    one = slave(SCENE.replace("force: [push, 0]", "force: [push*cos(t), 0]"), ["sled.ax"])
    one.setup_experiment(0.0, None, None)
    one.exit_initialization_mode()
    for push in (0.0, 5.0, 0.0, 3.0, 0.0):
        put(one, push=push)
        assert value_of(one, "sled.ax") == pytest.approx(push / 2, abs=1e-9)


def test_a_restored_state_needs_no_other_start(slave):
    """No equilibrium of a sled on a rail exists with a push: a state is restored without one, in the same simulation."""
    unsprung = SCENE.replace(SCENE[SCENE.index("  spring") : SCENE.index("  pusher")], "")
    one = slave(unsprung.replace(", velocity: [1, 0]}}", "}}\nstart: equilibrium"), ["sled.x"])
    one.setup_experiment(0.0, None, None)
    one.exit_initialization_mode()
    put(one, push=5.0)
    assert one.do_step(0.0, 0.5)
    kept, at = one._get_fmu_state(), value_of(one, "sled.x")
    ends = []
    for t in (0.5, 1.0):
        put(one, push=-3.0)
        assert one.do_step(t, 0.5)
        one._set_fmu_state(kept)
        assert value_of(one, "push") == 5.0 and value_of(one, "sled.x") == at
        assert one.do_step(0.5, 0.5)
        ends.append(value_of(one, "sled.x"))
    assert ends[0] == ends[1] == pytest.approx(5 / 2 / 2, rel=1e-6)
    assert len(slave.made) == 1
    put(one, push=0.0)
    one.setup_experiment(0.0, None, 1e-10)
    one.exit_initialization_mode()
    one._set_fmu_state(kept)  # with another tolerance: in another simulation
    assert value_of(one, "sled.x") == pytest.approx(at, rel=1e-9) and len(slave.made) == 3


def test_steps_from_a_restored_state_do_not_depend_on_those_before(slave):
    """To the last bit, in the same simulation and in a new one."""
    one = slave(SCENE, ["sled.x"])
    one.setup_experiment(0.0, None, None)
    one.exit_initialization_mode()
    assert one.do_step(0.0, 0.1)
    kept, ends = one._get_fmu_state(), []
    for other in (one, one, type(one)(instance_name="other", resources=one.resources)):
        other._set_fmu_state(kept)
        for k in range(30):
            assert other.do_step(0.1 + 0.01 * k, 0.01)
        ends.append(value_of(other, "sled.x"))
    assert ends[0] == ends[1] == ends[2] and len(slave.made) == 2


ROD = """
dimensions: 3
bodies:
  rod:
    type: flexible
    mesh: meshes/rod.vtu
    units: {{length: 1 m}}
    material: {{E: 1e9, nu: 0.3, density: 1000}}
    interfaces: {{root: {{plane: {{point: [0, 0, 0], normal: [1, 0, 0]}}}}}}
    modes: 2
joints: {{clamp: {{type: fixed, i: rod.root, j: ground}}}}
requests: {{carried: fz(clamp)}}
run: {{duration: 2, output: 0.01}}
{more}
"""


@pytest.mark.long
def test_an_fmu_has_the_meshes_of_its_scene(tmp_path):
    """In folders below that of the scene; files of other folders are refused."""
    (tmp_path / "own" / "meshes").mkdir(parents=True)
    mesh = (EXAMPLES / "flexible" / "flexible_rod.vtu").read_bytes()
    (tmp_path / "own" / "meshes" / "rod.vtu").write_bytes(mesh)
    path = tmp_path / "own" / "rod.yaml"
    path.write_text(ROD.format(more="gravity: [0, 0, -9.81]"), encoding="utf-8")
    fmu = tmp_path / "rod.fmu"
    stiffmbs.build_fmu(path, fmu)
    shutil.rmtree(tmp_path / "own")
    found = simulated(fmu)["carried"]
    assert np.isfinite(found).all() and found.mean() > 0
    (tmp_path / "rod.vtu").write_bytes(mesh)
    path = tmp_path / "there" / "rod.yaml"
    path.parent.mkdir()
    path.write_text(ROD.format(more="").replace("meshes/rod.vtu", "../rod.vtu"), encoding="utf-8")
    with pytest.raises(InputError, match=r"with files of its own folder only: .*rod\.vtu"):
        stiffmbs.build_fmu(path, fmu)


def test_outputs_have_units(tmp_path):
    path = tmp_path / "bar.yaml"
    shutil.copyfile(Path(__file__).parents[2] / "examples" / "bar_pendulum.yaml", path)
    stiffmbs.build_fmu(path, tmp_path / "bar.fmu", ["hinge.fy", "bar.angle"])
    about = read_model_description(str(tmp_path / "bar.fmu"), validate=True)
    found = {each.name: each.unit for each in about.modelVariables if each.causality == "output"}
    assert found == {"hinge.fy": "N", "bar.angle": "rad"}
    assert {unit.name for unit in about.unitDefinitions} == {"N", "rad"}
