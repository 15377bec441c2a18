"""The server of a page: who may ask it, what it gives away, and what happens when processes end."""

import contextlib
import hmac
import http.client
import json
import os
import shutil
import socket
import threading
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main

from ..conftest import EXAMPLES

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text((EXAMPLES / "cart_pendulum.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    return path


@pytest.fixture
def page(scene):
    opened = stiffmbs.open(scene, browser=False)
    yield opened
    opened.close()


class Client:
    def __init__(self, page):
        _, _, self.host, self.token, _ = page.url.split("/")

    def ask(self, path, content=None, token=None, **heads):
        """Status, headers and text of an answer; a header None is left out."""
        port = int(self.host.split(":")[1])
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        method = "GET" if content is None else "POST"
        body = None if content is None else json.dumps(content).encode()
        given = {"Host": self.host, **({"Origin": f"http://{self.host}"} if body else {}), **heads}
        connection.putrequest(method, f"/{self.token if token is None else token}/{path}", skip_host=True)
        for name, value in given.items():
            if value is not None:
                connection.putheader(name, value)
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders(body)
        answer = connection.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read().decode(errors="replace")

    def job(self, what, text, page="one", **rest):
        status, _, lines = self.ask("job", {"page": page, "what": what, "text": text, **rest})
        assert status == 200
        return json.loads(lines.strip().splitlines()[-1])


@pytest.mark.parametrize("token", ["", "wrong", "%00", "%C3%A9"])
def test_nothing_without_the_token(page, token):
    for path in ("", "start", "own/live.js", "schema"):
        assert Client(page).ask(path, token=token)[0] == 403
    assert Client(page).ask("save", {"text": "x"}, token=token)[0] == 403


@pytest.mark.parametrize(
    "heads",
    [
        {"Host": "evil.example"},
        {"Host": "127.0.0.1:1"},
        {"Host": ""},
        {"Host": None},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
    ],
)
def test_another_host_or_origin_is_refused(page, heads, scene):
    before = scene.read_text()
    for path, content in (("start", None), ("save", {"text": "x", "over": True}), ("job", {"what": "solve"})):
        try:
            status = Client(page).ask(path, content, **heads)[0]
        except ConnectionError:  # the server closes an invalid request before it reads the body
            continue
        assert status in (400, 403)
    assert scene.read_text() == before


def test_a_change_without_an_origin_is_refused(page):
    assert Client(page).ask("save", {"text": "x", "over": True}, Origin=None)[0] == 403


def test_pages_have_a_policy(page):
    status, heads, text = Client(page).ask("")
    assert status == 200 and "default-src 'none'" in heads["content-security-policy"]
    assert "unsafe-eval" not in heads["content-security-policy"] and "<script>" not in text
    assert heads["referrer-policy"] == "no-referrer"


@pytest.mark.parametrize(
    "path",
    [
        "own/../app.py", "own/..%2fapp.py", "own/%2e%2e/%2e%2e/page.py", "own//etc/passwd", "own/live.html", "scene.yaml",
        "own/README.md", "../../etc/passwd",
    ],
)  # fmt: skip
def test_no_file_is_served_by_its_path(page, path):
    assert Client(page).ask(path)[0] in (403, 404)


def test_it_listens_on_the_loopback_interface_alone(page):
    port = int(Client(page).host.split(":")[1])
    for address in {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}:
        if not address.startswith("127."):
            with pytest.raises(OSError), socket.create_connection((address, port), timeout=2):
                pass


@pytest.mark.parametrize("body", [[], "text", 3, None])
def test_a_request_that_is_no_object_is_refused(page, body):
    status, _, text = Client(page).ask("job", body if body is not None else [])
    assert status == 400 and "expected" in text


@pytest.mark.long
def test_two_pages_have_their_own_texts(page, scene):
    client, text = Client(page), scene.read_text()
    one = client.job("solve", text, page="one")
    other = client.job("solve", text.replace("L: 0.6 m", "L: 0.7 m"), page="other")
    values = [next(p["value"] for p in found["parameters"] if p["name"] == "L") for found in (one, other)]
    assert values == [0.6, 0.7]


def test_another_saved_text_is_not_lost(page, scene):
    client = Client(page)
    start = json.loads(client.ask("start")[2])
    assert client.ask("save", {"text": start["text"] + "# one\n", "digest": start["digest"]})[0] == 200
    status, _, said = client.ask("save", {"text": start["text"] + "# other\n", "digest": start["digest"]})
    assert status == 409 and "has changed" in said and scene.read_text().endswith("# one\n")
    assert client.ask("save", {"text": start["text"] + "# other\n", "over": True})[0] == 200
    assert scene.read_text().endswith("# other\n")


@pytest.mark.long
def test_a_killed_solver_is_replaced(page, scene, monkeypatch):
    from stiffmbs.live.workers import Process

    started = []
    first = Process.__init__
    monkeypatch.setattr(Process, "__init__", lambda self, *given: (started.append(self), first(self, *given))[1])
    client = Client(page)
    text = scene.read_text()
    client.job("solve", text, page="ahead")  # takes the one that was started before
    client.job("solve", text)
    for process in started:
        process._process.kill()
        process._process.wait()
    found = [client.job("solve", text)["status"] for _ in range(2)]
    assert found[-1] == "done"


@pytest.mark.long
def test_a_model_becomes_a_text():
    model = stiffmbs.Model(gravity=(0, -9.81))
    model.add("ball", stiffmbs.Body(mass=1, inertia=1))
    page = stiffmbs.open(model, browser=False, duration=0.5)
    try:
        client = Client(page)
        start = json.loads(client.ask("start")[2])
        assert start["editable"] and "ball" in start["text"]
        answer = client.job("solve", start["text"])
        assert answer["status"] == "done" and answer["end"] == 0.5
        assert "<iframe" in page._repr_html_() and page.url in page._repr_html_()
        assert client.ask("save", {"text": "x"})[0] == 409
    finally:
        page.close()


@pytest.mark.long
def test_a_model_with_python_functions_asks_before_they_run():
    called = []
    model = stiffmbs.Model()
    model.add("a", stiffmbs.Body(mass=1, inertia=1, position=(1, 0)))
    model.add("f", stiffmbs.PythonForce(i="a", of=("a.x",), function=lambda x: (called.append(1), (-x[0], 0, 0))[1]))
    called.clear()
    page = stiffmbs.open(model, browser=False)
    try:
        client = Client(page)
        start = json.loads(client.ask("start")[2])
        assert not start["editable"]
        assert client.job("solve", start["text"])["status"] == "consent" and not called
        assert client.job("solve", start["text"], allow=True)["status"] == "done" and called
    finally:
        page.close()


@pytest.mark.parametrize(
    ("name", "expected"),
    [("model.adm", "convert"), ("no_folder/scene.yaml", "no_folder"), (".", "expected a scene"), ("x.txt", "yaml")],
)
def test_what_is_no_scene_is_refused(tmp_path, monkeypatch, name, expected):
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(main, ["open", name, "--no-browser"])
    assert found.exit_code == 2 and expected in found.output and "Traceback" not in found.output


@pytest.mark.parametrize("port", [-1, 65536, "8000", None])
def test_what_is_no_port_is_refused(scene, port):
    with pytest.raises(stiffmbs.InputError, match="expected a free one"):
        stiffmbs.open(scene, port=port, browser=False)


def test_a_taken_port_is_refused(page, scene):
    port = Client(page).host.split(":")[1]
    found = CliRunner().invoke(main, ["open", str(scene), "--no-browser", "--port", port])
    assert found.exit_code == 2 and f"--port {port}" in found.output


@pytest.mark.long
def test_a_new_file_is_created_by_saving(tmp_path):
    path = Path(tmp_path / "new.yaml")
    page = stiffmbs.open(path, browser=False)
    try:
        client = Client(page)
        start = json.loads(client.ask("start")[2])
        assert start["text"] == "" and not path.exists()
        assert "Ctrl-Space" in client.job("solve", "")["message"]
        assert client.ask("save", {"text": "name: x\n", "digest": start["digest"]})[0] == 200
        assert path.read_text() == "name: x\n"
    finally:
        page.close()


@pytest.mark.long
def test_each_start_has_a_new_token(scene):
    tokens = set()
    for _ in range(3):
        page = stiffmbs.open(scene, browser=False)
        tokens.add(Client(page).token)
        page.close()
    assert len(tokens) == 3 and all(len(token) >= 32 for token in tokens)


def test_the_server_proves_itself_without_the_token(page):
    client, number = Client(page), "0123456789abcdef" * 2
    status, _, proof = client.ask(number, token="prove")
    assert status == 200 and proof == hmac.new(client.token.encode(), number.encode(), "sha256").hexdigest()
    for other in ("", "0", number + "0", number.upper(), "../start"):
        assert client.ask(other, token="prove")[0] in (403, 404)
    assert client.ask(number, token="prove", Origin="http://evil.example")[0] == 403
    assert client.ask(number, token="prove", Host="evil.example")[0] == 403


def test_odd_requests_are_refused_and_change_nothing(page, scene):
    client, before = Client(page), scene.read_text()
    digest = json.loads(client.ask("start")[2])["digest"]
    for content in (
        {"digest": digest},
        {"text": None, "digest": digest},
        {"text": "\ud800", "digest": digest},
        {"text": "x", "over": "false"},
    ):
        assert client.ask("save", content)[0] == 409
    assert scene.read_text() == before
    with socket.create_connection(("127.0.0.1", int(client.host.split(":")[1])), timeout=10) as line:
        line.sendall(f"OPTIONS * HTTP/1.1\r\nHost: {client.host}\r\nConnection: close\r\n\r\n".encode())
        assert line.recv(100).split()[1] in (b"400", b"403", b"404")
    scene.unlink()
    os.mkfifo(scene)
    status, _, said = client.ask("start")
    assert status == 409 and "regular file" in said
    assert client.ask("save", {"text": "x", "over": True})[0] == 409


def test_consent_is_true_alone():
    model = stiffmbs.Model()
    model.add("a", stiffmbs.Body(mass=1, inertia=1, position=(1, 0)))
    model.add("f", stiffmbs.PythonForce(i="a", of=("a.x",), function=lambda x: (-x[0], 0, 0)))
    page = stiffmbs.open(model, browser=False)
    try:
        client = Client(page)
        text = json.loads(client.ask("start")[2])["text"]
        for allow in ("false", "true", 1, [True]):
            assert client.job("solve", text, allow=allow)["status"] == "consent"
    finally:
        page.close()


@pytest.mark.long
def test_a_worker_that_does_not_read_does_not_block_the_server(scene, monkeypatch):
    from stiffmbs.live import workers

    monkeypatch.setattr(workers.sys, "executable", shutil.which("sleep"))
    monkeypatch.setattr(workers, "arguments", lambda file: ["60"])
    page = stiffmbs.open(scene, browser=False)
    try:
        client = Client(page)
        for _ in range(3):
            threading.Thread(target=_unanswered, args=(client,), daemon=True).start()
        time.sleep(0.5)
        assert client.ask("start")[0] == 200
    finally:
        page.close()


BROKEN = {
    "killed while it writes": 'sys.stdin.readline(); sys.stdout.write(\'{"number": 1, "sta\'); sys.stdout.flush()',
    "no JSON": "sys.stdin.readline(); print('hello', flush=True); time.sleep(300)",
    "no text": "sys.stdin.readline(); sys.stdout.buffer.write(b'\\xff\\n'); sys.stdout.flush(); time.sleep(300)",
    "reads no more": "os.close(0); time.sleep(300)",
    "writes no more": "os.close(1); time.sleep(300)",
}


@pytest.mark.parametrize("code", BROKEN.values(), ids=BROKEN)
def test_a_broken_worker_is_reported_at_once(scene, monkeypatch, code):
    from stiffmbs.live import workers

    monkeypatch.setattr(workers, "arguments", lambda file: ["-c", f"import os, sys, time; {code}"])
    page = stiffmbs.open(scene, browser=False)
    try:
        assert "ended unexpectedly" in Client(page).job("solve", "x" * 1_000_000)["message"]
    finally:
        page.close()


def _unanswered(client):
    """Ask for a solution from a worker that never reads: no answer comes, which this thread need not report."""
    with contextlib.suppress(OSError, http.client.HTTPException):
        client.ask("job", {"page": "a", "what": "solve", "text": "x" * 3_000_000})


@pytest.mark.long
def test_a_file_that_is_no_scene_is_not_quoted(page, tmp_path):
    (tmp_path / "secret.txt").write_text("root:x:0:0\nhunter2\n")
    said = Client(page).job("solve", "include: secret.txt\nbodies: {a: {mass: 1, inertia: 1}}\n")["message"]
    assert "secret.txt" in said and "hunter2" not in said
