"""The cache of derived and compiled equations: what is damaged is made again, and the command that looks after it."""

import json
import multiprocessing
import os
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import spatial
from stiffmbs.analyses import warm
from stiffmbs.cache import entries as kept
from stiffmbs.cache.contents import OTHER, PART, clear, stored
from stiffmbs.commands.main import main
from stiffmbs.compile import record
from stiffmbs.compile.compile_model import kinds_of
from stiffmbs.compile.kind import sorted_out
from stiffmbs.compile.machine import compiler as machine
from stiffmbs.compile.machine.routines import compile_unit, forget, units
from stiffmbs.compile.symbolic import derive
from stiffmbs.elements.tyres.names import SAMPLE
from stiffmbs.model import model
from stiffmbs.model import spatial_model as spatial_model
from stiffmbs.tyres import TyreProperties

NAME = f"kernel-{'0' * 40}"
SOURCE = "def twice(x):\n    return 2.0*x\n"


@pytest.fixture
def directory(tmp_path, monkeypatch):
    monkeypatch.setenv(kept.DIRECTORY_VARIABLE, str(tmp_path))
    return tmp_path


def run_in_a_process(arguments, directory, **options):
    environment = {**os.environ, "STIFFMBS_CACHE": str(directory)}
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment, **options)


def test_a_damaged_entry_is_none(directory):
    kept.write(NAME, b"content")
    assert kept.read(NAME) == b"content"
    entry = kept.folder() / NAME
    whole = entry.read_bytes()
    for damaged in (whole[:-1], b"", whole[:20], whole[:-1] + b"x"):
        entry.write_bytes(damaged)
        assert kept.read(NAME) is None
    assert [path.name for path in kept.folder().iterdir()] == [NAME]


@pytest.mark.parametrize("place", ["/dev/null/nowhere", "a file"])
def test_where_nothing_can_be_written_all_works_but_nothing_is_kept(directory, monkeypatch, place):
    (directory / "a file").write_text("of the user's")
    monkeypatch.setenv(kept.DIRECTORY_VARIABLE, str(directory / place))
    kept.write(NAME, b"content")
    assert kept.read(NAME) is None
    machine.compiled_source.cache_clear()
    assert machine.compiled_source(SOURCE, "twice", "float64(float64)").call(21.0) == 42.0
    assert not any(own.entries for own in stored(kept.cache_directory()).values())
    assert (directory / "a file").read_text() == "of the user's"


def test_compiled_code_is_read_back(directory, monkeypatch):
    machine.compiled_source.cache_clear()
    assert machine.compiled_source(SOURCE, "twice", "float64(float64)").call(21.0) == 42.0
    machine.compiled_source.cache_clear()
    monkeypatch.setattr(machine, "object_code", lambda *_: pytest.fail("compiled again"))
    assert machine.compiled_source(SOURCE, "twice", "float64(float64)").call(21.0) == 42.0
    assert len(list(kept.folder().iterdir())) == 1


def test_a_kind_is_derived_once_for_its_record_and_its_rare_kernels(directory, examples, monkeypatch):
    kinds = kinds_of(stiffmbs.load_scene(examples / "half_car.yaml"))
    derived, usual = [], derive.derive
    monkeypatch.setattr(derive, "derive", lambda kind: derived.append(kind) or usual(kind))
    for made_before in (record._record_of, record._terms, record.source_of):
        made_before.cache_clear()
    sources = [record.source_of(kind, term_set) for term_set in ("motion", *record.RARE) for kind in kinds]
    assert len(sources) > len(derived) == len(set(derived)) == len(kinds)


@pytest.mark.long
def test_a_run_on_a_damaged_cache_gives_the_same_numbers(examples, directory, tmp_path):
    command = ["-m", "stiffmbs", "run", str(examples / "bar_pendulum.yaml"), "--duration", "0.1", "--json"]
    first = run_in_a_process(command, directory, cwd=tmp_path)
    entries = sorted(kept.folder().iterdir())
    for k, entry in enumerate(entries):
        content = entry.read_bytes()
        entry.write_bytes([content[: len(content) // 2], b"", os.urandom(len(content))][k % 3])
    again = run_in_a_process(command, directory, cwd=tmp_path)
    assert again.stderr == ""
    assert json.loads(again.stdout)["channels"] == json.loads(first.stdout)["channels"]
    assert sorted(kept.folder().iterdir()) == entries
    assert all(kept.read(entry.name) is not None for entry in entries)


def write_many(content):
    for _ in range(100):
        kept.write(NAME, content)


@pytest.mark.long
def test_two_processes_that_write_one_entry_leave_it_whole_at_all_times(directory):
    contents = b"a" * 200_000, b"b" * 150_000
    kept.write(NAME, contents[0])
    context = multiprocessing.get_context("spawn")
    writers = [context.Process(target=write_many, args=(content,)) for content in contents]
    for writer in writers:
        writer.start()
    seen = set()
    while any(writer.is_alive() for writer in writers):
        seen.add(kept.read(NAME))
    for writer in writers:
        writer.join()
    assert seen <= set(contents)
    assert [path.name for path in kept.folder().iterdir()] == [NAME]


def test_clearing_removes_entries_of_all_versions_and_nothing_else(directory):
    kept.write(NAME, b"content")
    kept.write(f"record-{'1' * 40}", b"{}")
    other = directory / f"entries-{'0' * 12}"
    other.mkdir()
    for entry in (other / NAME, directory / ("a" * 40), kept.folder() / f"{PART}x"):
        entry.write_bytes(b"of another version, or left half written")
    of_the_user = directory / "notes.txt"
    of_the_user.write_text("keep")
    (directory / "sub").mkdir()
    found = stored(kept.cache_directory())
    assert (found["kernel"].entries, found["record"].entries, found["routine"].entries) == (1, 1, 0)
    assert found[OTHER].entries == 3
    assert clear(kept.cache_directory()).entries == 5
    assert sorted(path.name for path in directory.iterdir()) == ["notes.txt", "sub"]
    assert clear(kept.cache_directory()).entries == 0


def test_the_command_shows_and_clears(directory):
    kept.write(NAME, b"content")
    shown = json.loads(CliRunner().invoke(main, ["cache", "show", "--json"]).output)
    assert shown["directory"] == str(directory)
    assert shown["kernel"] == {"entries": 1, "bytes": 32 + len(b"content")}
    assert str(directory) in CliRunner().invoke(main, ["cache", "show"]).output
    assert "removed 1 entries" in CliRunner().invoke(main, ["cache", "clear"]).output
    assert json.loads(CliRunner().invoke(main, ["cache", "show", "--json"]).output)["kernel"]["entries"] == 0


@pytest.mark.parametrize(("dimensions", "described"), [(2, model), (3, spatial_model)])
def test_every_kind_of_element_is_among_the_usual_ones(dimensions, described):
    found = {type(element) for _, element in warm.usual_elements(dimensions).data().elements()}
    with_forms = {kind for kind in (*described.JOINTS.values(), *described.FORCES.values()) if kind.forms}
    assert found >= with_forms and len(with_forms) >= len(described.JOINTS) + len(described.FORCES) - 1  # beam sections


def test_routines_of_all_solvers_are_found():
    found = {(module.rpartition(".")[2], name) for module, signatures, *_ in units() for name, _ in signatures}
    assert {
        ("ida_loop", "advance"),
        ("runge_kutta", "advance"),
        ("dynamics", "assemble"),
        ("evaluate", "terms"),
        ("variations", "advance"),
    } <= found


def loaded_by_a_run(scene, solver, directory, tmp_path):
    heavy = "('sympy', 'numba', 'matplotlib', 'rich', 'stiffmbs.compile.symbolic.derive', 'stiffmbs.compile.machine.translate')"
    code = (
        "import sys\nfrom stiffmbs.commands.main import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n"
        f"    print([m for m in {heavy} if m in sys.modules], file=sys.stderr)\n    raise\n"
    )
    arguments = ["-c", code, "run", str(scene), "--duration", "0.1", "--json", "--solver", solver]
    done = run_in_a_process(arguments, directory, cwd=tmp_path)
    assert done.returncode == 0
    return done.stderr.strip()


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_a_warm_run_imports_nothing_that_derives_or_compiles(examples, tmp_path, solver):
    loaded_by_a_run(examples / "cart_pendulum.yaml", solver, kept.cache_directory(), tmp_path)
    assert loaded_by_a_run(examples / "cart_pendulum.yaml", solver, kept.cache_directory(), tmp_path) == "[]"


@contextmanager
def asked_for(monkeypatch):
    """Collect the names of compiled and derived entries that are looked up within a context, by code that was never asked before."""
    names, read = set(), kept.read

    def noted(name):
        names.update({name} if name.startswith(("kernel-", "record-", "routine-")) else ())
        return read(name)

    with monkeypatch.context() as patch:
        patch.setattr(kept, "read", noted)
        for known in (record._record_of, record.source_of):
            known.cache_clear()
        forget()
        yield names
    forget()


def named_alone(follows_from, source):
    kept.read(kept.name_of(*follows_from, machine.machine()))
    return {name: None for name, _ in source.signatures}


@pytest.mark.long(60)
def test_after_warming_first_runs_compile_nothing(examples, monkeypatch):
    """All that runs look up is among what warming looks up, and would compile. Kinds that no run has are left out."""
    scenes = ("cart_pendulum", "crank_slider", "chain", "four_bars", "stick_slip", "heavy_top", "spatial_chain")
    with asked_for(monkeypatch) as by_runs:
        for scene in scenes:
            stiffmbs.run(examples / f"{scene}.yaml", duration=0.1, solver="auto")
    with asked_for(monkeypatch) as by_warming, monkeypatch.context() as patch:
        patch.setattr(machine, "_loaded", named_alone)
        for kind in warm.usual_kinds():
            if record.of_installed(record._entry(kind) or "") in by_runs:
                record.compile_kind(kind)
        for unit in units():
            compile_unit(unit)
    assert len(by_runs) > 50 and by_runs <= by_warming


@pytest.mark.long
def test_the_command_compiles_kinds_and_routines(directory, examples, monkeypatch):
    kinds, loops = warm.usual_kinds()[:1], units()[:1]
    monkeypatch.setattr(warm, "usual_kinds", lambda: kinds)
    monkeypatch.setattr(warm, "units", lambda: loops)
    monkeypatch.setattr(warm, "process_pool", ThreadPoolExecutor)
    forget()
    done = CliRunner().invoke(main, ["cache", "warm", str(examples / "simple_pendulum.yaml")])
    assert done.exit_code == 0, done.output
    made = {path.name.partition("-")[0] for path in kept.folder().iterdir()}
    assert {"record", "kernel", "routine"} <= made


def test_one_equation_in_the_plane_and_in_space_has_a_record_for_each(directory):
    """An equation of coordinates alone reads the same in both, but its coordinates have other places."""
    columns = []
    for dimensions, inertia in ((2, 1), (3, [1, 1, 1])):
        bodies = f"{{a: {{mass: 1, inertia: {inertia}}}, b: {{mass: 1, inertia: {inertia}}}}}"
        scene = f"{{dimensions: {dimensions}, bodies: {bodies}, joints: {{tie: {{type: equation, zero: a.x - b.y}}}}}}"
        system = stiffmbs.compile_model(stiffmbs.read_scene(scene))
        columns.append(system.term("motion", "J").column.tolist())
    assert columns == [[0, 4], [0, 7]]


BUSHING = spatial.Bushing(i="block", j="ground", stiffness=(1, 1, 1, 1, 1, 1))
TYRE = spatial.MagicFormulaTyre(i="block", properties=TyreProperties(coefficients=SAMPLE))


@pytest.mark.parametrize(("element", "called"), [(BUSHING, "wrench.py"), (TYRE, "magic_formula.py")])
def test_a_change_of_what_equations_call_makes_their_record_anew(monkeypatch, element, called):
    model = spatial.Model()
    model.add("block", spatial.Body(mass=1, inertia=(1, 1, 1)))
    model.add("mount", element)
    described = model.data()
    kind, _ = sorted_out("mount", described.forces["mount"], described)
    before, read = record._entry(kind), Path.read_bytes
    assert record._entry(kind) == before
    monkeypatch.setattr(record, "_content", record._content.__wrapped__)  # reads files again, as another process
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + (b"#" if path.name == called else b""))
    assert record._entry(kind) != before


@pytest.mark.long
@pytest.mark.parametrize("first", ["shared", "revolute_spherical"])
def test_the_name_of_a_record_does_not_depend_on_what_was_imported_first(tmp_path, first):
    """Both modules ask for the same generic class of rods."""
    model = spatial.Model()
    model.add("block", spatial.Body(mass=1, inertia=(1, 1, 1)))
    model.add("rod", spatial.Distance(i="block", j="ground", length=1.0))
    described = model.data()
    kind, _ = sorted_out("rod", described.joints["rod"], described)
    script = (
        f"import stiffmbs.elements.spatial.joints.{first}, pickle, sys\nfrom stiffmbs.compile.record import _entry\n"
        "print(_entry(pickle.load(sys.stdin.buffer)))"
    )
    names = subprocess.run([sys.executable, "-c", script], input=pickle.dumps(kind), capture_output=True, check=True)
    assert names.stdout.decode().strip() == record._entry(kind)


@pytest.mark.long
def test_sources_do_not_depend_on_the_order_of_sets():
    """Python orders sets by a seed of the process; sums in kernels must not follow it, or numbers change with a recompilation."""
    script = (
        "from stiffmbs.model.read_scene import read_scene\n"
        "from stiffmbs.compile.compile_model import compile_model\n"
        "from stiffmbs.compile.record import _derived\n"
        "scene = read_scene('bodies: {a: {mass: 1, inertia: 1}, b: {mass: 1, inertia: 1}}\\n"
        "forces: {f: {type: bushing, i: a, j: b, stiffness: [1, 2, 3], damping: [1, 2, 3]}}')\n"
        "print([sorted(_derived(group.kind).sources.items()) for group in compile_model(scene).groups])\n"
    )
    found = [
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert found[0] == found[1]


def test_the_name_of_a_record_does_not_follow_what_was_asked_of_its_kind(examples):
    kind = next(iter(kinds_of(stiffmbs.load_scene(examples / "half_car.yaml"))))
    vars(kind).pop("has_tables", None)
    before = record._entry(kind)
    assert not kind.has_tables and record._entry(kind) == before


OPTIONS = """
gravity: [0, -9.81]
bodies: {a: {mass: 1, inertia: 1, position: [1, 0], angle: 0.5}}
joints: {pin: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}}
options:
  held:
    free: {}
    sprung: {forces: {spring: {type: torsion_spring, i: a, j: ground, stiffness: 1}}}
    wrong: {forces: {spring: {type: torsion_spring, i: b, j: ground, stiffness: 1}}}
"""


def test_warming_compiles_a_scene_with_all_its_options(tmp_path, monkeypatch):
    monkeypatch.setenv(kept.DIRECTORY_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setattr(warm, "process_pool", ThreadPoolExecutor)
    monkeypatch.setattr(warm, "usual_kinds", tuple)
    monkeypatch.setattr(warm, "units", tuple)
    scene, seen = tmp_path / "scene.yaml", []
    scene.write_text(OPTIONS)
    other = tmp_path / "other.yaml"
    other.write_text("bodies: [")
    faults = sorted(warm.warm([scene, other], lambda *numbers: seen.append(numbers)))
    assert "other.yaml, line" in faults[0] and "forces.spring.i" in faults[1] and len(faults) == 2
    assert seen[-1] == (5, 5)  # both scenes; pin, spring and weight of the first
    monkeypatch.setattr(machine, "drafted", lambda *_: pytest.fail("compiled"))
    for kind in kinds_of(stiffmbs.load_scene(scene, [("choose.held", "sprung")])):
        record.compile_kind(kind)


def test_a_run_by_radau_after_one_by_bdf_derives_nothing(examples, monkeypatch):
    kinds = kinds_of(stiffmbs.load_scene(examples / "half_car.yaml"))
    for kind in kinds:
        record.record_of(kind)
    record.source_of.cache_clear()
    monkeypatch.setattr(record, "_terms", lambda kind: pytest.fail("derived"))
    assert any(record.source_of(kind, "effort_tangent") for kind in kinds)
