"""The page in a real browser: text, errors, sliders, and plots, without a message on its console."""

import http.server
import json
import re
import subprocess
import sys
import threading
import time
from typing import ClassVar

import pytest

import stiffmbs

from ..conftest import EXAMPLES
from ..show.page import browser

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")
pytest.importorskip("websocket")
pytestmark = [pytest.mark.long, pytest.mark.skipif(browser.found() is None, reason="no Chromium is installed")]
OF_SOFTWARE = "GL Driver Message"
"""Messages of drawing without a graphics card."""


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    with browser.tab(tmp_path_factory.mktemp("browser")) as found:
        yield found


def leave(tab):
    tab.run("LIVE.saved = LIVE.editor?.state.doc.toString()")  # so that leaving the page asks nothing
    tab.do("Page.navigate", url="about:blank")
    tab.wait("location.href === 'about:blank' && document.readyState === 'complete'")


@pytest.fixture
def opened(tab, tmp_path):
    """Opens a text in a page; nothing may have gone wrong when all is done."""
    pages = []

    def make(text):
        path = tmp_path / "scene.yaml"
        path.write_text(text, encoding="utf-8")
        pages.append(stiffmbs.open(path, browser=False))
        tab.errors.clear()
        tab.requests.clear()
        tab.do("Page.navigate", url=pages[-1].url)
        tab.wait("typeof LIVE === 'object' && LIVE.answers > 0 && LIVE.complete")
        return path

    yield make
    leave(tab)
    for page in pages:
        page.close()
    assert [error for error in tab.errors if OF_SOFTWARE not in error] == []
    server, _, _ = pages[-1].url.rpartition("/")[0].rpartition("/")
    own = (pages[-1].url, f"{server}/prove/", "data:", "blob:", "about:")
    assert all(url.startswith(own) for url in tab.requests)


TEXT = (EXAMPLES / "cart_pendulum.yaml").read_text(encoding="utf-8")


def replace(tab, old, new):
    """Edit the text as a user does, and wait for the answer."""
    before = tab.run("LIVE.answers")
    tab.run(
        f"(() => {{ const text = LIVE.editor.state.doc.toString(), from = text.indexOf({json.dumps(old)});"
        f"LIVE.editor.dispatch({{changes: {{from, to: from + {len(old)}, insert: {json.dumps(new)}}}}}); }})()"
    )
    tab.wait(f"LIVE.answers > {before}")


def curve(tab):
    return tab.run("Array.from(shown.plotted.chosen[0].values).slice(0, 400)")


def test_an_error_appears_at_its_line_and_goes(tab, opened):
    opened(TEXT)
    replace(tab, "mass: 10 kg", "mass: ten")
    assert tab.run("LIVE.errors.map((one) => one.line)") == [10]
    assert "mass" in tab.run("document.getElementById('headline').textContent")
    tab.wait("document.querySelector('.cm-lint-marker-error')")
    replace(tab, "mass: ten", "mass: 10 kg")
    assert tab.run("LIVE.errors") == []
    assert tab.run("document.getElementById('headline').textContent").startswith("Completed")


def test_a_slider_moves_the_curve_and_writes_its_value(tab, opened):
    opened(TEXT)
    before, answers, t = curve(tab), tab.run("LIVE.answers"), tab.run("shown.time.t")
    tab.run(
        "(() => { const r = document.getElementById('slider-L'); r.value = 700; r.dispatchEvent(new Event('input')); })()"
    )
    tab.wait(f"LIVE.answers > {answers}")
    moved = curve(tab)
    assert moved != before and "L: 0.6 m" in tab.run("LIVE.editor.state.doc.toString()")
    assert tab.run("shown.time.t") >= t
    answers = tab.run("LIVE.answers")
    tab.run("document.getElementById('slider-L').dispatchEvent(new Event('change'))")
    tab.wait(f"LIVE.answers > {answers}")
    assert "L: 0.84 m" in tab.run("LIVE.editor.state.doc.toString()") and curve(tab) == moved
    answers = tab.run("LIVE.answers")
    tab.run("document.getElementById('undo').click()")
    tab.wait(f"LIVE.answers > {answers}")
    assert "L: 0.6 m" in tab.run("LIVE.editor.state.doc.toString()") and curve(tab) == before


def test_a_pinned_run_stays_behind_those_that_follow(tab, opened):
    opened(TEXT)
    before, press = curve(tab), "document.getElementById('pin').click()"
    tab.run(press)
    replace(tab, "mass: 10 kg", "mass: 30 kg")
    assert tab.run("shown.data.runs.map((run) => run.name)") == ["now", "pinned"]
    assert curve(tab) != before
    first = "shown.data.runs[{}].bodies.cart[0]"
    assert tab.run(f"{first.format(0)}[40] !== {first.format(1)}[40]")
    assert tab.run("document.querySelector('.legend').textContent").startswith("nowpinned")
    replace(tab, "mass: 30 kg", "mass: 10 kg")  # the pinned run again
    assert tab.run(f"Math.abs({first.format(0)}[40] - {first.format(1)}[40])") < 1e-4
    tab.run(press)
    assert tab.run("shown.data.runs.length") == 1
    replace(tab, "mass: 10 kg", "mass: 20 kg")
    assert tab.run("shown.data.runs.length") == 1


def test_every_text_has_the_contrast_of_wcag_with_and_without_an_error(tab, opened):
    opened(TEXT)
    assert tab.run(browser.FAINT) == []
    replace(tab, "mass: 10 kg", "mass: ten")
    tab.wait("document.querySelector('.cm-lint-marker-error')")
    assert tab.run(browser.FAINT) == []


def test_a_dark_page_has_the_contrast_of_wcag(tab, opened):
    opened(TEXT)
    tab.do("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    try:
        assert tab.run("getComputedStyle(document.body).backgroundColor") == "rgb(20, 23, 27)"
        tab.run("document.getElementById('check').click()")
        tab.wait("document.querySelector('#text pre').textContent.includes('degrees of freedom')")
        assert tab.run(browser.FAINT) == []
    finally:
        tab.do("Emulation.setEmulatedMedia", features=[])


def test_notes_results_and_errors_do_not_move_the_picture(tab, opened):
    opened(TEXT)
    place = "document.querySelector('.viewer').getBoundingClientRect().top"
    before = tab.run(place)
    tab.run("document.getElementById('notes').open = true")
    assert tab.run(place) == before
    tab.run("document.getElementById('check').click()")
    tab.wait("document.querySelector('#text pre').textContent.includes('degrees of freedom')")
    tab.run("document.getElementById('sweep').click()")
    assert tab.run(place) == before
    replace(tab, "mass: 10 kg", f"mass: {'ten' * 80}")
    assert tab.run("LIVE.errors.length") == 1 and tab.run(place) == before
    assert "ten" in tab.run("document.getElementById('headline').title")
    assert float(tab.run("getComputedStyle(document.querySelector('.viewer')).opacity")) < 1


OPTIONS = """
options:
  load:
    none: {}
    heavy: {forces: {push: {type: force, i: bar, force: [0, -50 N]}}}
    "two parts": {forces: {push: {type: force, i: bar, force: [0, -90 N]}}}
"""


@pytest.mark.parametrize(
    "written", ["", "choose: {load: none} # the load\n", "choose:\n  # of the load\n  load: none\n", "choose: {}\n"]
)
def test_a_selector_writes_its_choice_into_the_text(tab, opened, written):
    opened(TEXT + OPTIONS + written)
    select = "document.querySelector('#choices select')"
    assert tab.run(f"[...{select}.options].map((one) => one.value)") == ["none", "heavy", "two parts"]
    for word, text in (("heavy", "load: heavy"), ("two parts", 'load: "two parts"')):
        before, answers = curve(tab), tab.run("LIVE.answers")
        tab.run(f"(() => {{ const s = {select}; s.value = '{word}'; s.onchange(); }})()")
        tab.wait(f"LIVE.answers > {answers}")
        found = tab.run("LIVE.editor.state.doc.toString()")
        assert (
            text in found and found.count("choose:") == 1 and found.count("#") == (TEXT + OPTIONS + written).count("#")
        )
        assert tab.run(f"{select}.value") == word and tab.run("LIVE.errors") == [] and curve(tab) != before


def test_every_control_is_reached_by_the_tab_key(tab, opened):
    opened(TEXT)
    tab.run("document.activeElement.blur()")
    controls = "[...document.querySelectorAll('button, input, select, summary')].filter((e) => !e.disabled && e.checkVisibility())"
    tab.run(f"window.reached = new Set(); {controls}.forEach((e) => e.addEventListener('focus', () => reached.add(e)))")
    for _ in range(tab.run(f"{controls}.length") + 10):
        tab.key("Escape", number=27)  # leaves the text, where Tab indents
        tab.key("Tab", number=9)
    assert tab.run(f"{controls}.filter((e) => !reached.has(e)).map((e) => e.id || e.textContent)") == []


def test_a_further_channel_is_fetched(tab, opened):
    opened(TEXT)
    tab.run("shown.plotted.choose('cart.x')")
    tab.wait("shown.plotted.chosen.length === 2")
    replace(tab, "270 N/m", "300 N/m")
    assert tab.run("shown.plotted.chosen.map((c) => c.name)") == ["rail.fy", "cart.x"]


def test_completion_follows_the_schema(tab, opened):
    opened(TEXT)

    def offered(before):
        script = (
            "(() => { const doc = CM.EditorState.create({doc: %s}); return LIVE.completer({state: doc, pos: doc.doc.length, explicit: true})"
            "?.options.map((one) => one.label) ?? []; })()"
        )
        return tab.run(script % json.dumps(before))

    assert {"bodies", "joints", "run"} <= set(offered(""))
    assert {"mass", "inertia", "markers"} <= set(offered("bodies:\n  a:\n    "))
    assert "mass" not in offered("bodies:\n  a:\n    mass: 1\n    ")
    assert {"revolute", "drive"} <= set(offered("joints:\n  a: {type: "))
    assert "stiffness" not in offered("joints:\n  a: {type: revolute, ") and "i" in offered(
        "joints:\n  a: {type: revolute, "
    )
    assert {"ground", "b", "b.tip"} <= set(
        offered("bodies:\n  b:\n    markers: {tip: {point: [0, 0]}}\njoints:\n  a: {i: ")
    )
    assert {"radau", "bdf"} <= set(offered("run: {solver: "))


def test_analyses_sweep_and_save(tab, opened):
    path = opened(TEXT)
    tab.run("document.getElementById('check').click()")
    tab.wait("document.querySelector('#text pre').textContent.includes('degrees of freedom')")
    tab.run("document.getElementById('sweep').click()")
    tab.run("document.getElementById('count').value = 3")
    tab.run("document.getElementById('sweeper').requestSubmit()")
    tab.wait("document.querySelector('#text pre').textContent.includes('bands')")
    replace(tab, "270 N/m", "300 N/m")
    assert tab.run("document.getElementById('saved').textContent") == "not saved"
    tab.run("document.getElementById('save').click()")
    tab.wait("document.getElementById('saved').textContent === ''")
    assert "300 N/m" in path.read_text(encoding="utf-8")


def test_an_empty_page_offers_a_first_scene(tab, opened):
    opened("")
    assert not tab.run("document.getElementById('empty').hidden")
    tab.run("document.getElementById('first').click()")
    tab.wait("window.shown && shown.frames > 0")
    assert tab.run("document.getElementById('empty').hidden")
    tab.run("LIVE.saved = LIVE.editor.state.doc.toString()")


def started(path):
    """A server in a process of its own, and its address."""
    command = [sys.executable, "-m", "stiffmbs", "open", str(path), "--no-browser"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for line in process.stdout:
        if found := re.search(r"http://\S+", line):
            return process, found[0]
    raise AssertionError("no address")


def ready(tab, url):
    tab.do("Page.navigate", url=url)
    tab.wait("typeof LIVE === 'object' && LIVE.answers > 0")


class Impostor(http.server.BaseHTTPRequestHandler):
    """Server on the port of another one that has ended; it notes what it receives."""

    received: ClassVar[list[str]] = []

    def do_GET(self):
        self.received.append(self.path)
        self.send_response(200)
        self.end_headers()
        self.wfile.write(b"0" * 64)

    def do_POST(self):
        self.do_GET()

    def log_message(self, *given):
        pass


def test_a_killed_server_leaves_the_text_and_another_on_its_port_receives_nothing(tab, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(TEXT, encoding="utf-8")
    process, url = started(path)
    try:
        ready(tab, url)
        replace(tab, "270 N/m", "300 N/m")
        process.kill()
        process.wait()
        tab.run(
            "(() => { const text = LIVE.editor.state.doc.toString(), from = text.indexOf('300 N/m');"
            "LIVE.editor.dispatch({changes: {from, to: from + 3, insert: '310'}}); })()"
        )
        tab.wait("!document.getElementById('banner').hidden")
        assert "The text is still here" in tab.run("document.getElementById('banner').textContent")
        assert "310 N/m" in tab.run("LIVE.editor.state.doc.toString()")
        assert path.read_text(encoding="utf-8") == TEXT
        _, _, host, token, _ = url.split("/")
        Impostor.received.clear()
        with http.server.ThreadingHTTPServer(("127.0.0.1", int(host.split(":")[1])), Impostor) as impostor:
            threading.Thread(target=impostor.serve_forever, daemon=True).start()
            while not Impostor.received:
                time.sleep(0.05)
            replace(tab, "310 N/m", "320 N/m")
            tab.run("document.getElementById('save').click()")
            time.sleep(0.5)
            impostor.shutdown()
        assert all(path.startswith("/prove/") and token not in path for path in Impostor.received)
        assert not tab.run("document.getElementById('banner').hidden")
    finally:
        leave(tab)
        process.kill()
        tab.errors.clear()  # refused connections


def test_two_tabs_have_their_own_text_and_solver(tab, tmp_path, tmp_path_factory):
    path = tmp_path / "scene.yaml"
    path.write_text(TEXT, encoding="utf-8")
    page = stiffmbs.open(path, browser=False)
    try:
        with browser.tab(tmp_path_factory.mktemp("second")) as second:
            ready(tab, page.url)
            ready(second, page.url)
            replace(tab, "270 N/m", "300 N/m")
            assert "270 N/m" in second.run("LIVE.editor.state.doc.toString()")
            first, other = curve(tab), curve(second)
            assert first != other
            replace(second, "270 N/m", "300 N/m")
            assert curve(second) == first
            for one in (tab, second):
                leave(one)
                assert [error for error in one.errors if OF_SOFTWARE not in error] == []
    finally:
        page.close()


def test_the_bodies_are_shown_before_the_first_solution(tab, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(TEXT.replace("rtol: 1e-6", "rtol: 1e-6, max_step: 4e-6"), encoding="utf-8")
    page = stiffmbs.open(path, browser=False)
    try:
        tab.do("Page.navigate", url=page.url)
        tab.wait("typeof LIVE === 'object' && LIVE.preview && LIVE.preview.frames > 0")
        assert tab.run("LIVE.shown") is None
        assert tab.run("document.querySelectorAll('#mechanism canvas').length") == 1
        replace(tab, ", max_step: 4e-6", "")
        tab.wait("LIVE.shown && LIVE.preview.ended")
        assert tab.run("document.querySelectorAll('#mechanism .viewer').length") == 1
        leave(tab)
        assert [error for error in tab.errors if OF_SOFTWARE not in error] == []
    finally:
        page.close()
