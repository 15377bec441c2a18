"""Commands in the resident process: as in a process of their own, safe, and gone when it is not needed."""

import json
import os
import resource
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import pytest

from stiffmbs.commands import resident, serving

from ..conftest import EXAMPLES

COMMAND = [sys.executable, "-m", "stiffmbs"]
PATIENCE = 8.0
"""Time, s, without a command after which the resident process ends in these tests."""
LIMIT = 60.0


def until(holds):
    end = time.monotonic() + LIMIT
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.fixture(scope="module")
def cache():
    """A cache directory with a short path, as sockets need it; at the end the resident process has ended."""
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)
        until(lambda: not sockets(folder))


def environment(cache, patience=PATIENCE):
    return {**os.environ, "STIFFMBS_CACHE": str(cache), resident.VARIABLE: str(patience)}


def sockets(cache):
    return [path for path in Path(cache, resident.FOLDER).glob("*") if path.is_socket()]


def told(*arguments, cache, patience=PATIENCE, **options):
    found = subprocess.run([*COMMAND, *arguments], capture_output=True, env=environment(cache, patience), **options)
    return found.returncode, found.stdout, found.stderr


def started(cache, **options):
    """Start the resident process."""
    told("--version", cache=cache, **options)
    until(lambda: sockets(cache))


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["check", "scene.yaml"],
        ["check", "missing.yaml"],
        ["check", "--json", "-"],
        ["run", "scene.yaml", "--duration", "0.1", "-q", "-o", "out.csv"],
        ["version", "unknown"],
    ],
    ids=" ".join,
)
def test_a_command_writes_the_same_and_ends_alike(arguments, cache, tmp_path):
    text = (EXAMPLES / "cart_pendulum.yaml").read_bytes()
    (tmp_path / "scene.yaml").write_bytes(text)
    variables = dict(os.environ)  # and none that libraries of this process have set behind its back
    alone = subprocess.run([*COMMAND, *arguments], capture_output=True, input=text, cwd=tmp_path, env=variables)
    written = [path.read_bytes() for path in tmp_path.glob("out.csv")]
    started(cache)
    status, out, err = told(*arguments, cache=cache, input=text, cwd=tmp_path)
    assert (status, err) == (alone.returncode, alone.stderr)
    assert [line for line in out.splitlines() if b"cost" not in line] == [
        line for line in alone.stdout.splitlines() if b"cost" not in line
    ]
    assert [path.read_bytes() for path in tmp_path.glob("out.csv")] == written


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_reach_the_command(number, cache, tmp_path):
    started(cache)
    scene, results = str(EXAMPLES / "cart_pendulum.yaml"), tmp_path / "out.npz"
    long = [*COMMAND, "run", "-v", scene, "--duration", "1e5", "--set", "run.output=0.1", "-o", str(results)]
    process = subprocess.Popen(long, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(cache))
    while b"solving" not in process.stderr.readline():
        assert process.poll() is None
    time.sleep(0.5)
    process.send_signal(number)
    out, err = process.communicate(timeout=LIMIT)
    assert process.returncode == 1, err
    assert b"interrupted" in out + err
    assert results.exists()


def test_a_command_ends_with_the_process_in_the_terminal(cache, tmp_path):
    """The resident process, which waits for its commands, could not end otherwise."""
    started(cache)
    long = [
        *COMMAND,
        "run",
        str(EXAMPLES / "cart_pendulum.yaml"),
        "--duration",
        "1e5",
        "--set",
        "run.output=0.1",
        "-o",
        str(tmp_path / "out.npz"),
    ]
    process = subprocess.Popen(long, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment(cache))
    time.sleep(1.5 * PATIENCE)
    assert sockets(cache)  # it waits for the command; the end of this module waits for it
    process.kill()
    process.wait()


def test_a_command_in_a_folder_that_is_gone_fails_alone(cache, tmp_path):
    started(cache)
    line = ["stiffmbs", "--version"]
    content = json.dumps([line, [sys.executable, *line], str(tmp_path / "gone"), sys.path, dict(os.environ)]).encode()
    (path,) = sockets(cache)
    with socket.socket(socket.AF_UNIX) as connection, open(os.devnull, "r+b") as quiet:
        connection.connect(str(path))
        socket.send_fds(connection, [len(content).to_bytes(8, "little")], [quiet.fileno()] * 3)
        connection.sendall(content)
        assert connection.recv(1) == resident.ACCEPTED
        assert connection.recv(1) == b"\1"
    assert sockets(cache) == [path]


def test_the_user_alone_reaches_the_socket(cache):
    started(cache)
    assert stat.S_IMODE((cache / resident.FOLDER).stat().st_mode) == 0o700


def test_a_folder_that_others_write_to_is_not_used(tmp_path):
    folder = tmp_path / resident.FOLDER
    folder.mkdir()
    folder.chmod(0o777)
    assert told("--version", cache=tmp_path)[0] == 0
    assert not list(folder.iterdir())


@pytest.mark.parametrize(
    "patience, note", [("", b""), ("0", b""), ("soon", b"STIFFMBS_RESIDENT: found 'soon', expected")]
)
def test_without_a_time_no_process_is_started(patience, note, tmp_path):
    status, _, err = told("--version", cache=tmp_path, patience=patience)
    assert status == 0
    assert note in err and bool(note) == bool(err)
    assert not (tmp_path / resident.FOLDER).exists()


def test_after_a_change_commands_under_way_keep_their_status_and_new_ones_run_as_usual(monkeypatch):
    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as listening:
        listening.bind(f"{folder}/socket")
        listening.listen()
        monkeypatch.setenv(resident.VARIABLE, "0.2")
        before = signal.getsignal(signal.SIGCHLD), signal.set_wakeup_fd(-1)
        server = serving.Server(listening)
        try:
            monkeypatch.setattr(server._sources, "have_changed", lambda: True)
            client, told = socket.socketpair()
            names, telling = os.pipe()
            os.close(telling)
            child = os.fork()
            if not child:
                time.sleep(1)
                os._exit(3)
            server.running[child] = told, names
            waiting = socket.socket(socket.AF_UNIX)
            waiting.connect(f"{folder}/socket")
            assert server.wait() is None
            assert client.recv(1) == b"\3"
            with suppress(ConnectionResetError):
                assert waiting.recv(1) == b""
        finally:
            signal.signal(signal.SIGCHLD, before[0])
            signal.set_wakeup_fd(before[1])


def test_processes_with_other_limits_have_a_resident_process_of_their_own(monkeypatch, cache):
    monkeypatch.setenv("STIFFMBS_CACHE", str(cache))
    usual = resident.address()
    assert resident.address() == usual
    monkeypatch.setenv("PYTHONWARNINGS", "error")
    assert resident.address() != usual
    monkeypatch.undo()
    monkeypatch.setenv("STIFFMBS_CACHE", str(cache))
    limits = resource.getrlimit(resource.RLIMIT_CORE)
    resource.setrlimit(resource.RLIMIT_CORE, (0, limits[1]))
    try:
        found = resident.address()
    finally:
        resource.setrlimit(resource.RLIMIT_CORE, limits)
    assert found == usual if limits[0] == 0 else found != usual


@pytest.mark.parametrize(
    "line, is_passed_on",
    [
        (["-m", "stiffmbs", "check", "a.yaml"], True),
        (["/usr/bin/stiffmbs", "check", "a.yaml"], True),
        (["-X", "importtime", "-m", "stiffmbs", "check", "a.yaml"], False),
        (["/usr/bin/stiffmbs", "check", "/dev/fd/63"], False),
    ],
)
def test_commands_that_only_their_own_process_can_run_are_not_passed_on(line, is_passed_on, monkeypatch):
    monkeypatch.setattr(sys, "orig_argv", [sys.executable, *line])
    monkeypatch.setattr(sys, "argv", ["stiffmbs", *line[-2:]])
    monkeypatch.setattr(sys, "gettrace", lambda: None)
    assert resident.can_be_passed_on() is is_passed_on


def test_changed_sources_are_noticed(monkeypatch, tmp_path):
    file = tmp_path / "changing.py"
    file.write_text("")
    module = ModuleType("changing")
    module.__file__ = str(file)
    monkeypatch.setitem(sys.modules, "changing", module)
    sources = serving.Sources()
    assert not sources.have_changed()
    os.utime(file, ns=(1, 1))
    assert sources.have_changed()
    file.unlink()
    assert sources.have_changed()
