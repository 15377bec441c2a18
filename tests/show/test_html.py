"""What notebooks show."""

from html.parser import HTMLParser

import pytest

import stiffmbs
from stiffmbs import Body, Model


class Tags(HTMLParser):
    """Counts tags, and sees that each is closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.words = [], []
        self.images = 0
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.images += tag == "img"
        if tag not in ("img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.mark.long
@pytest.mark.parametrize("name", ["cart_pendulum.yaml", "heavy_top.yaml"])
def test_a_scene_a_report_and_a_solution_are_shown(examples, name):
    scene = stiffmbs.load_scene(examples / name)
    shown = Tags(scene._repr_html_())
    assert shown.images == 1 and {*scene.bodies, *scene.joints} <= set(shown.words)
    report = stiffmbs.check(scene)
    assert str(report.degrees_of_freedom) in Tags(report._repr_html_()).words
    solution = stiffmbs.run(scene, duration=0.1)
    shown = Tags(solution._repr_html_())
    assert shown.images == 1 and next(iter(solution)) in shown.words and solution.message in shown.words


def test_a_model_is_shown_while_it_is_built_and_names_cannot_break_the_page():
    model = Model("<script>")
    assert Tags(model._repr_html_()).images == 0
    model.add("ball", Body(mass=1, inertia=1))
    shown = Tags(model._repr_html_())
    assert "<script>" in shown.words and "ball" in shown.words
