"""Long texts are read by libyaml: what stands in them is exactly what ruamel.yaml reads, or they are left to it."""

from io import StringIO
from pathlib import Path

import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

import stiffmbs
from stiffmbs.describe.files import libyaml, yaml_text
from stiffmbs.describe.files.libyaml import NotSureError, read_by_libyaml
from stiffmbs.describe.files.yaml_text import LONG, read_yaml
from tests.bench.drives import SCENES

ROOT = Path(stiffmbs.__file__).parent
FILES = sorted([*ROOT.glob("**/*.yaml"), *ROOT.parent.glob("examples/**/*.yaml"), *Path(SCENES).glob("*.yaml")])


def described(found, seen):
    """Types, values, the order of names, and which mappings and lists are one and the same."""
    if isinstance(found, dict | list | tuple | set):
        if id(found) in seen:
            return seen[id(found)]
        seen[id(found)] = len(seen)
        parts = found.items() if isinstance(found, dict) else found
        return type(found).__name__, [
            described(part, seen) for pair in parts for part in (pair if isinstance(found, dict) else [pair])
        ]
    return type(found).__name__, repr(found)


def by_python(text):
    try:
        return described(YAML(typ="safe", pure=True).load(StringIO(text)), {})
    except Exception as error:
        return type(error).__name__


def assert_same(text):
    """Whether libyaml reads it; then as Python does."""
    try:
        found = described(read_by_libyaml(text), {})
    except NotSureError:
        return False
    assert found == by_python(text)
    return True


READ = (
    "a: 1", "{a: 1, b: [x, 'y', \"z\"]}", "a: [1, 2.5, 1e3, -0.0, 010, 0o10, 0x1F, 1_000, 0b11, .5, 5., +4, .inf, -.INF, .nan]",
    "[true, True, TRUE, yes, on, off, No, y, ~, null, Null, NULL, nULL, 12:30, 190:20:30, 1.e3, 1e400, 123456789012345678901234567890]",
    "a: 2001-01-01\nb: 2001-12-14t21:59:43.10-05:00", "0: a\ntrue: b\nnull: c\n2.5: d", "'1': a\n1: b", "a:\nb:\n  -\n  - c", "a: &x [1]\nb: *x",
    "a: &x {y: 1, z: [2]}\nb: {<<: *x, y: 3}\nc:\n  w: 0\n  <<: *x\n", "a: {<<: {b: 1}, c: 2}", "a: {<<: {}, c: 2}", "a: {'<<': 1}", "a: &x\nb: *x\n",
    "a: |\n  x\n  # y\n\nb: >-\n  x\n   y\n\n  z\n", "a: 'it''s'", "a: x\n  y\n\n  z # c\n", "a: [1,\n 2] # c", "a: 1 # \u00e9\n\u00e9: \u6f22", "'a' : 1",
    "a: b#c", "a: x*y(z), *w", "[a?b]", "{a:1}", "a: [x:1]", "force: ['(mu*max(0, -x))', \"step(t, 0, 0, 1, 1)\"]", "- - a\n  - b\n-\n  c: d\n", '{"a": [1, {"b": null}]}',
)  # fmt: skip
LEFT = (
    "", "# c", "a: 1\na: 2", "a: {b: 1, b: 2}", "1: a\n1.0: b", "a: \tb", "\ta: 1", "a: b\t# c", "a: \"\\/\"", "a: \"\\ud800\"", "%YAML 1.1\n---\na: yes",
    "--- a\n--- b", "--- a", "a\n...\n", "a: !!int '3'", "a: !x 3", "a: !", "a: ! 3", "a: *x", "a: &x 1\nb: &x 2\nc: *x", "&a [&a b, *a]", "a: &a [*a]",
    "&b: c", "&b:30", "[&a :b, *a]", "a: &x 1\n*x:", "a: &x 1\nb: *x:", '["":b]', '{"a":1}', "[?,,b]", "? a\n: b", "? [a]\n: b", "1: a\ntrue: b", "a: x && y", "{a::b}",
    "|\n#", "a: |#\n  x\n", "a: |2#\n   x", "a: |-\n  \n   x\n", "a: |2\n   x", "=: 1", "a: =", "a: <<", "{<<: 1}", "{<<: [{a: 1}]}", "{<<: {a: 1}, <<: {b: 2}}",
    "a: 2001-13-01", "a: " + "9" * 5000, "a: \x7f", "a: \U0001f600", "\ufeffa: 1", "a: 1\rb: 2", "a: [", "]", "a: b: c", "a: 'x", " a: 1\nb: 2",
    "[" * 42 + "]" * 42, "[" * 100_000, "{a: " * 100_000, "- " * 100_000, "[" * 100_000 + "]" * 100_000,
)  # fmt: skip


@pytest.mark.parametrize("text", READ)
def test_what_libyaml_reads_is_what_python_reads(text):
    assert assert_same(text)


@pytest.mark.parametrize("text", READ)
def test_lines_that_end_as_on_windows_are_read_as_others(text):
    assert assert_same(text.replace("\n", "\r\n"))


@pytest.mark.parametrize("text", LEFT, ids=lambda text: repr(text[:20]))
def test_what_it_may_read_otherwise_is_left_to_python(text):
    with pytest.raises(NotSureError):
        read_by_libyaml(text)


PIECES = (
    "a", "b: ", "c: 1", "x", "1", "-1.5", "0x1F", "1e3", "12:30", "2001-01-01", "~", "yes", "true", "'", '"', "'a'", '"b": ', ": ", ":", "? ", "?", ", ", ",", "- ", "-",
    "{", "}", "[", "]", "[a, b]", "{a: b}", "[]", "{}", "&m ", "&m {a: 1, b: [2]}", "*m", "<<: *m", "<<: ", "<<", "!", "!!str ", "|\n", ">-\n", "|\n  x\n # y\n", "#", " # c\n",
    "\n", "\n\n", "\n  ", "\n- ", " ", "  ", "=", "@", "`", "%", ".", "---", "\\", "\t", "\r\n", "\xa0", "\xe9", "k" * 1030 + ": ",
)  # fmt: skip
LINES = st.tuples(
    st.sampled_from(("", "", "", "  ", " ", "    ")), st.lists(st.sampled_from(PIECES), min_size=1, max_size=5)
)
TEXTS = st.lists(LINES, min_size=1, max_size=6).map(
    lambda lines: "\n".join(space + "".join(words) for space, words in lines)
)


@pytest.mark.long
@settings(max_examples=500, deadline=None)
@given(TEXTS)
@example("a: {&b12:30}")
def test_no_text_is_read_otherwise(text):
    assert_same(text)


@st.composite
def contents(draw):
    """Scenes as they are written: numbers, formulas, words and lists by names."""
    words = st.text("abcxyz_019 .+-*/()^<>=#|:,'~\xe9", max_size=12)
    numbers = st.one_of(st.integers(), st.floats(), st.booleans(), st.none(), st.dates())
    return draw(
        st.recursive(words | numbers, lambda part: st.lists(part) | st.dictionaries(words, part), max_leaves=20)
    )


@pytest.mark.long
@settings(max_examples=100, deadline=None)
@given(contents(), st.sampled_from((None, True, False)), st.booleans())
def test_what_was_written_is_read_back(content, in_one_line, by_ruamel):
    if by_ruamel:
        writer, out = YAML(typ="safe", pure=True), StringIO()
        writer.default_flow_style = in_one_line
        writer.dump(content, out)
        text = out.getvalue()
    else:
        text = yaml.safe_dump(content, default_flow_style=in_one_line, allow_unicode=True)
    assert_same(text)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_all_scenes_and_parts_are_read_by_both(file):
    assert assert_same(file.read_text(encoding="utf-8"))


LONG_TEXT = "bodies:\n" + "".join(
    f"  b{k}: {{mass: {k}, inertia: 1e-3, at: [x*{k}, yes]}}\n" for k in range(LONG // 30)
)


@pytest.fixture
def read(monkeypatch):
    """The texts that Python reads."""
    found = []

    def counted(text, source):
        found.append(text)
        return by_itself(text, source)

    by_itself = yaml_text._read_by_python
    monkeypatch.setattr(yaml_text, "_read_by_python", counted)
    return found


def test_a_long_text_is_read_by_libyaml_and_a_short_one_by_python(read):
    assert len(LONG_TEXT) > LONG
    found = read_yaml(LONG_TEXT, "scene")
    assert not read
    assert found["bodies"]["b7"] == {"mass": 7, "inertia": 1e-3, "at": ["x*7", "yes"]}
    read_yaml(LONG_TEXT[:100].rpartition("\n")[0], "scene")
    assert len(read) == 1


@pytest.mark.parametrize(("name", "value"), [("__with_libyaml__", False), (None, (0, 2, 4))])
def test_without_the_libyaml_that_was_compared_python_reads_the_same(read, monkeypatch, name, value):
    quick = described(read_yaml(LONG_TEXT, "scene"), {})
    monkeypatch.setattr(*((yaml, name, value) if name else (libyaml, "COMPARED", value)))
    assert described(read_yaml(LONG_TEXT, "scene"), {}) == quick
    assert len(read) == 1


@pytest.mark.long
@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("  b3: {}\n", "found the name 'b3' twice"),
        ("  x: [1\n", "found text that is not YAML"),
        ("  x: " + "[" * 3000 + "\n", "found values nested too deep"),
        ("  x: " + "9" * 400 + "\n", "found a whole number beyond 1e308"),
        ("  x: 2001-13-01\n", "does not fit its tag"),
    ],
)
def test_faults_of_long_texts_are_told_as_python_tells_them(fault, message):
    with pytest.raises(stiffmbs.InputError, match=message) as told:
        read_yaml(LONG_TEXT + fault, "scene")
    if "twice" in message:
        assert f"line {LONG_TEXT.count(chr(10)) + 1}" in str(told.value)
