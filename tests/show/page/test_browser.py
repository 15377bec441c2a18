"""Pages in a real browser: they draw, play and scrub, by mouse and by keys, without an error or a request."""

import io
from itertools import product

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.show.handling import write_handling

from ...conftest import EXAMPLES
from ..test_handling_page import found
from ..test_study_page import page_of
from . import browser

pytest.importorskip("jinja2")
pytest.importorskip("websocket")
pytestmark = pytest.mark.skipif(browser.found() is None, reason="no Chromium is installed")


@pytest.fixture(scope="module")
def tab(tmp_path_factory):
    with browser.tab(tmp_path_factory.mktemp("browser")) as found:
        yield found


@pytest.fixture
def opened(tab, tmp_path):
    """Writes and opens the page of a command; checks that nothing went wrong when all is done."""

    def make(command, scene, *options):
        path = tmp_path / "page.html"
        result = CliRunner().invoke(main, [command, str(scene), "-o", str(path), *map(str, options)])
        assert result.exit_code == 0, result.output
        tab.requests.clear()
        tab.open(path)
        return path

    yield make
    assert tab.errors == []
    assert all(url.startswith(("file://", "data:", "blob:")) for url in tab.requests)


def pixels(tab, selector):
    """The colors of an element on the screen, shape (height, width, 3)."""
    from PIL import Image

    tab.run(f"document.querySelector('{selector}').scrollIntoView()")
    tab.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    x, y, w, h = (
        int(v)
        for v in tab.run(
            f"(({{x, y, width, height}}) => [x, y, width, height])(document.querySelector('{selector}').getBoundingClientRect())"
        )
    )
    return np.asarray(Image.open(io.BytesIO(tab.picture())).convert("RGB"))[y : y + h, x : x + w].astype(int)


def coloured(image):
    """The part of an image that is neither white nor grey."""
    return (np.ptp(image, axis=2) > 30).mean()


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize(
    ("command", "scene", "options"),
    [
        pytest.param("report", "cart_pendulum", ["--no-verify"], marks=pytest.mark.long),
        ("animate", "bricard", ["--duration", 1]),
        ("animate", "half_car", ["--duration", 1]),
    ],
)
def test_the_mechanism_is_drawn_and_moves(tab, opened, command, scene, options):
    opened(command, EXAMPLES / f"{scene}.yaml", *options)
    first = pixels(tab, ".viewer canvas")
    assert coloured(first) > 0.002
    tab.run("shown.time.set(shown.time.start + 0.6*(shown.time.end - shown.time.start))")
    then = pixels(tab, ".viewer canvas")
    assert (np.abs(then - first).max(axis=2) > 60).mean() > 0.0005


@pytest.mark.long
def test_it_plays_to_its_end_and_again(tab, opened):
    """However slowly the machine draws: the first time slowly until it is seen to play, then to the end at once."""
    opened("animate", EXAMPLES / "four_bar.yaml")
    speed = "((s) => { const e = document.querySelector('.controls select'); e.value = s; e.onchange(); })"
    press = "document.querySelector('.controls button').click()"
    tab.run(f"{speed}('0.01'); {press}")
    tab.wait("shown.time.t > 0")
    assert tab.run("document.querySelector('.controls button').textContent") == "Pause"
    tab.run(f"{speed}('5')")
    tab.wait("!shown.time.playing")
    assert tab.run("shown.time.t") == pytest.approx(1)
    tab.run(f"{speed}('0.01'); {press}")
    tab.wait("shown.time.playing && shown.time.t < 0.9")
    assert float(tab.run("document.querySelector('input[type=range]').value")) < 900


@pytest.mark.long
def test_bodies_turn_as_they_do_in_the_run(tab, opened):
    """A bar let go from the horizontal hangs when it is lowest."""
    solution = stiffmbs.run(EXAMPLES / "bar_pendulum.yaml")
    opened("animate", EXAMPLES / "bar_pendulum.yaml")
    tab.run("shown.shown.state.forces = shown.shown.state.names = false; document.querySelector('.legend')?.remove()")
    sizes = []
    for time in (0.0, solution.time[np.argmin(solution["bar.y"])]):
        tab.run(f"shown.time.set({time})")
        where = np.argwhere(np.ptp(pixels(tab, ".viewer canvas"), axis=2) > 60)
        sizes.append(np.ptp(where, axis=0))
    assert sizes[0][1] > 5 * sizes[0][0] and sizes[1][0] > 5 * sizes[1][1]


@pytest.mark.long
def test_the_scrubber_sets_the_time_of_plots_and_mechanism(tab, opened):
    opened("animate", EXAMPLES / "cart_pendulum.yaml")
    before = pixels(tab, ".plot canvas")
    assert coloured(before) > 0.001
    tab.run("(() => { const s = document.querySelector('input[type=range]'); s.value = 250; s.oninput(); })()")
    assert tab.run("shown.time.t") == pytest.approx(2.5)
    assert tab.run("document.querySelector('.controls output').textContent") == "t = 2.50 s"
    assert (np.abs(pixels(tab, ".plot canvas") - before).max(axis=2) > 60).any()


@pytest.mark.long
def test_a_drag_zooms_and_a_click_sets_the_time(tab, opened):
    opened("animate", EXAMPLES / "bar_pendulum.yaml")
    tab.run("document.querySelector('.plot').scrollIntoView()")
    x, y, w, h = tab.run(
        "(({x, y, width, height}) => [x, y, width, height])(document.querySelector('.plot canvas').getBoundingClientRect())"
    )
    tab.drag((x + w * 0.3, y + h / 2), (x + w * 0.6, y + h / 2))
    tab.drag((x + w / 2, y + h / 2), (x + w / 2, y + h / 2))
    time = tab.run("shown.time.t")
    assert 0.3 * 3 < time < 0.6 * 3  # the middle of what was dragged over, not the middle of the run
    assert time == pytest.approx(0.45 * 3, abs=0.15)


@pytest.mark.long
def test_keys_move_the_time(tab, opened):
    opened("animate", EXAMPLES / "bar_pendulum.yaml")
    tab.run("document.querySelector('.viewer canvas').focus()")
    for _ in range(3):
        tab.key("ArrowRight")
    assert tab.run("shown.time.t") == pytest.approx(3 * 3 / 200)
    tab.key("End")
    assert tab.run("shown.time.t") == pytest.approx(3)
    tab.key("Home")
    tab.key(" ", "Space", " ")
    tab.wait("shown.time.t > 0.1")
    assert tab.run("shown.time.playing")
    tab.key(" ", "Space", " ")


@pytest.mark.long
def test_a_body_is_followed_and_a_path_is_traced(tab, opened):
    opened("animate", EXAMPLES / "rolling_disc.yaml", "--duration", 2)
    tab.run("shown.shown.state.follow = 'disc'; shown.shown.stale = true")
    plain = pixels(tab, ".viewer canvas")
    tab.run("shown.time.set(2)")
    followed = pixels(tab, ".viewer canvas")
    middles = [np.argwhere(np.ptp(image, axis=2) > 60).mean(axis=0) for image in (plain, followed)]
    assert np.abs(middles[1] - middles[0]).max() < 60
    tab.run("shown.shown.addTrace({body: 'disc', point: [0, 0, 0.3]}); shown.shown.stale = true")
    assert (np.abs(pixels(tab, ".viewer canvas") - followed).max(axis=2) > 60).any()


def press(tab, words):
    tab.run(f"[...document.querySelectorAll('button')].find((one) => one.textContent === {words!r}).click()")


@pytest.mark.long
def test_a_car_is_seen_from_the_side_the_front_and_above(tab, opened):
    """Also at a later time, while the camera follows it: the extents on the screen are those of length, width and height."""
    opened("animate", EXAMPLES / "car.yaml", "--duration", 0.5)
    tab.run("shown.time.set(0.5)")
    views = tab.run("[...document.querySelectorAll('select')].map((one) => [...one.options].map((each) => each.value))")
    assert ["oblique", "front", "side", "top"] in views
    shapes = {}
    for view in ("side", "front", "top"):
        tab.run(
            f"(() => {{ const e = [...document.querySelectorAll('select')].find((one) => one.options[1]?.value === 'front'); e.value = '{view}'; e.onchange(); }})()"
        )
        blue = pixels(tab, ".viewer canvas").astype(int)
        where = np.argwhere((blue[..., 2] - blue[..., 0] > 60) & (blue[..., 2] > 120))
        assert len(where) > 500, view
        shapes[view] = np.ptp(where, axis=0)[::-1]  # across, upwards
        middle = where.mean(axis=0) / blue.shape[:2]
        assert (np.abs(middle - 0.5) < 0.3).all(), view
    across, upwards = ({view: shape[k] / shapes[view][0] for view, shape in shapes.items()} for k in (0, 1))
    assert across["side"] == 1 and upwards["side"] < 0.7  # longer than high
    assert 0.5 < upwards["front"] < 1.6  # about as high as wide
    assert 0.25 < upwards["top"] < 0.7  # x to the right


@pytest.mark.long
def test_the_instant_of_the_largest_force_is_shown(tab, opened):
    solution = stiffmbs.run(EXAMPLES / "half_car.yaml")
    opened("animate", EXAMPLES / "half_car.yaml")
    press(tab, "Largest force")
    loads = tab.run("shown.data.drawing.loads.map((one) => one.name)")
    sizes = {
        name: np.hypot(solution[f"{name}.fx"], solution[f"{name}.fy"]) for name in loads if f"{name}.fx" in solution
    }
    largest = max(sizes, key=lambda name: sizes[name].max())
    words = tab.run("[...document.querySelectorAll('.controls .hint')].map((one) => one.textContent)")
    assert f"in {largest}" in words
    assert tab.run("shown.time.t") == pytest.approx(solution.time[np.argmax(sizes[largest])], abs=0.03)
    assert tab.run("shown.shown.state.forces")


@pytest.mark.long
def test_names_and_titles_are_no_markup(tab, opened, tmp_path):
    scene = tmp_path / "odd.yaml"
    scene.write_text(
        "name: \"</title></script><img src=x onerror='window.hit=1'><svg onload='window.hit=1'>\"\n"
        "bodies: {a: {mass: 1, inertia: 1}}\njoints: {pin: {type: revolute, i: a, j: ground}}\n"
        "notes: ['<img src=x onerror=window.hit=1>']\nrun: {duration: 1, points: 11}  # <script>window.hit=1</script>\n"
    )
    opened("report", scene, "--no-verify")
    assert tab.run("window.hit === undefined && document.querySelectorAll('body img[src=x]').length === 0")
    assert "onerror" in tab.run("document.title")


@pytest.mark.long
def test_runs_are_drawn_over_each_other(tab, opened, tmp_path):
    paths = []
    for length in ("0.6 m", "0.9 m"):
        paths.append(tmp_path / f"L{length[:3]}.npz")
        stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml", [("L", length)])).save(paths[-1])
    opened("animate", EXAMPLES / "bar_pendulum.yaml", *paths)
    assert tab.run("[...document.querySelectorAll('.legend div')].map(e => e.textContent)")[:2] == ["L0.6", "L0.9"]
    tab.run("shown.time.set(0.5)")
    image = pixels(tab, ".viewer canvas")
    assert coloured(image) > 0.002
    tab.run(
        "shown.shown.state.forces = false; shown.data.runs[1].bodies.bar.forEach((c) => c.fill(0)); shown.shown.stale = true"
    )
    assert (np.abs(pixels(tab, ".viewer canvas") - image).max(axis=2) > 20).mean() > 0.001


@pytest.mark.long
def test_every_control_has_a_name_for_screen_readers(tab, opened):
    opened("report", EXAMPLES / "four_bar.yaml", "--no-verify")
    tree = tab.do("Accessibility.getFullAXTree")["nodes"]
    roles = {"button", "slider", "combobox", "checkbox", "textbox", "img", "image"}
    unnamed = [
        node["role"]["value"] for node in tree
        if not node.get("ignored") and node.get("role", {}).get("value") in roles and not node.get("name", {}).get("value")
    ]  # fmt: skip
    assert not unnamed


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("command", [["report", "--no-verify"], ["animate", "--duration", "1"], ["modes"]])
def test_every_text_has_the_contrast_of_wcag(tab, opened, command):
    opened(command[0], EXAMPLES / "half_car.yaml", *command[1:])
    tab.run("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    assert tab.run(browser.FAINT) == []
    tab.run("document.querySelector('h1, label').style.color = '#999'")  # the measure sees a faint text
    assert len(tab.run(browser.FAINT)) == 1


@pytest.mark.long
def test_a_report_fits_its_screen_and_its_labels_are_apart(tab, opened):
    """On a desktop and on a phone, light and dark; tables are never cut at the right edge."""
    opened("report", EXAMPLES / "crank_slider.yaml", "--no-verify", "--set", "run.points=101")
    try:
        for width, theme in ((1400, "light"), (390, "dark"), (390, "light")):
            tab.do("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
            tab.do("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
            assert tab.run("document.documentElement.scrollWidth") <= width
            wide = "[...document.querySelectorAll('table, figure, p')].filter((one) => one.getBoundingClientRect().right > innerWidth + 1).length"
            assert tab.run(wide) == 0
            assert tab.run(browser.OVERLAPS) == []
            assert tab.run(browser.SPLIT) == []
        assert [text for text in tab.run(browser.FAINT) if "kN" in text[0]] == []
    finally:
        tab.do("Emulation.clearDeviceMetricsOverride")
        tab.do("Emulation.setEmulatedMedia", features=[])


@pytest.mark.long
def test_names_in_a_picture_are_apart_while_it_moves(tab, opened):
    """Also those of elements at one point, on a small screen, where names without room are left out."""
    opened("animate", EXAMPLES / "crank_slider.yaml", "--set", "run.points=101")
    names = "[...document.querySelectorAll('.viewer .name:not(.tip)')].filter((one) => one.checkVisibility()).length"
    try:
        for width, least in ((1400, 9), (390, 6)):
            tab.do("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
            for part in (0, 0.3, 0.8):
                tab.run(f"shown.time.set({part} * shown.time.end)")
                tab.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
                assert tab.run(browser.COVERED_NAMES) == []
                assert tab.run(names) >= least
    finally:
        tab.do("Emulation.clearDeviceMetricsOverride")


@pytest.mark.long
def test_a_printed_report_has_all_columns_and_charts_side_by_side(tab, opened):
    """On paper of A4, whose width is that of a narrow screen; the colours are those of the light theme."""
    opened("report", EXAMPLES / "crank_slider.yaml", "--no-verify", "--set", "run.points=101")
    columns = "getComputedStyle(document.querySelector('{}')).gridTemplateColumns.split(' ').length"
    try:
        tab.do("Emulation.setDeviceMetricsOverride", width=688, height=971, deviceScaleFactor=1, mobile=False)
        tab.do(
            "Emulation.setEmulatedMedia", media="print", features=[{"name": "prefers-color-scheme", "value": "dark"}]
        )
        assert [tab.run(columns.format(one)) for one in (".two", ".polar")] == [2, 4]
        assert tab.run(
            "[...document.querySelectorAll('.minor')].every((one) => one.checkVisibility() || one.closest('details:not([open])'))"
        )
        assert tab.run("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        assert [tab.run(one) for one in (browser.OVERLAPS, browser.SPLIT)] == [[], []]
        assert tab.run("document.documentElement.scrollWidth") <= 688
    finally:
        tab.do("Emulation.clearDeviceMetricsOverride")
        tab.do("Emulation.setEmulatedMedia", media="", features=[])


def on_screens(tab, path):
    """Yield the widths of a desktop and a phone, light and dark, on which a page is open."""
    try:
        for width, theme in product((1400, 390), ("dark", "light")):
            tab.do("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
            tab.do("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
            tab.do("Page.navigate", url=f"file://{path}")
            tab.wait("document.readyState === 'complete' && document.querySelector('footer')")
            yield width
    finally:
        tab.do("Emulation.clearDeviceMetricsOverride")
        tab.do("Emulation.setEmulatedMedia", features=[])


@pytest.mark.long
def test_a_page_of_handling_tests_fits_its_screen(tab, tmp_path):
    """Two variants, light and dark: nothing is cut, broken or faint, and no labels cover each other."""
    path = tmp_path / "page.html"
    variants = {name: found(tests=("step_steer", "lane_change", "constant_speed")) for name in ("base", "softer")}
    write_handling(path, variants, dict.fromkeys(variants), {})
    for width in on_screens(tab, path):
        assert tab.run("document.documentElement.scrollWidth") <= width
        assert [tab.run(one) for one in (browser.OVERLAPS, browser.SPLIT, browser.FAINT)] == [[], [], []]


@pytest.mark.long
def test_a_page_of_kinematics_and_compliance_fits_its_screen(tab, tmp_path):
    """On a phone units stand below the names, so that no table is wider than the page."""
    path = tmp_path / "page.html"
    result = CliRunner().invoke(main, ["kc", str(EXAMPLES / "car.yaml"), "-o", str(path)])
    assert result.exit_code == 0, result.output
    wider = "[...document.querySelectorAll('.wide')].filter((one) => one.scrollWidth > one.clientWidth + 1).length"
    for width in on_screens(tab, path):
        assert tab.run(wider) == 0
        assert tab.run("document.documentElement.scrollWidth") <= width
        assert [tab.run(one) for one in (browser.OVERLAPS, browser.SPLIT, browser.FAINT)] == [[], [], []]


@pytest.mark.long
def test_a_page_of_a_study_fits_a_phone(tab, tmp_path):
    """Its table of cases scrolls by itself if it has many columns."""
    pytest.importorskip("xarray")
    page_of(tmp_path, (5, 3))
    try:
        tab.do("Emulation.setDeviceMetricsOverride", width=390, height=900, deviceScaleFactor=1, mobile=False)
        tab.do("Page.navigate", url=f"file://{tmp_path / 'page.html'}")
        tab.wait("document.readyState === 'complete' && document.querySelector('footer')")
        tab.run(
            "document.querySelectorAll('tr').forEach((row) => { for (let k = 0; k < 9; k++) row.append(row.lastElementChild.cloneNode(true)); })"
        )
        assert tab.run("document.documentElement.scrollWidth") <= 390
        assert [tab.run(one) for one in (browser.OVERLAPS, browser.SPLIT, browser.FAINT)] == [[], [], []]
    finally:
        tab.do("Emulation.clearDeviceMetricsOverride")


@pytest.mark.long
def test_a_mode_is_chosen_and_its_motion_repeats(tab, opened):
    opened("modes", EXAMPLES / "half_car.yaml")
    assert tab.run("document.querySelector('select').options.length") == 8  # the rigid motion is left out
    tab.run("(() => { const s = document.querySelector('select'); s.value = 3; s.onchange(); })()")
    found = stiffmbs.modes(EXAMPLES / "half_car.yaml").modes
    period = 2 * np.pi / abs(found[4].eigenvalues[0].imag)
    assert tab.run("[shown.time.end - shown.time.start, shown.data.runs.length]") == pytest.approx(
        [period, 1], rel=1e-3
    )
    assert tab.run("shown.data.runs[0].name").startswith(f"5: {found[4].natural_frequency:.4g} Hz")
    tab.run("shown.time.set(shown.time.end - 1e-9); shown.time.toggle()")
    tab.wait("shown.time.t < 0.9 * shown.time.end && shown.time.playing")
    tab.run("shown.time.toggle()")
