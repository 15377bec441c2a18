"""Plots that grow while a run goes on; matplotlib's own canvas stands for a window."""

import pytest

import stiffmbs

matplotlib = pytest.importorskip("matplotlib")


@pytest.fixture
def window(monkeypatch):
    from matplotlib import pyplot

    monkeypatch.setattr(pyplot, "show", lambda block=True: None)
    before = matplotlib.get_backend()
    pyplot.switch_backend("agg")
    yield pyplot
    pyplot.close("all")
    pyplot.switch_backend(before)


def test_curves_grow(examples, window):
    from stiffmbs.show.figure import show_live

    seen = []

    def solutions():
        for solution in stiffmbs.follow(examples / "cart_pendulum.yaml", every=0.0, duration=0.3):
            yield solution
            seen.append(len(window.gcf().axes[0].lines[0].get_xdata()))

    figure = show_live(solutions(), ("rail.fy",), "time")
    assert figure.y == ("rail.fy",)
    assert seen == sorted(seen)
    assert seen[-1] > seen[0]


def test_a_window_that_is_closed_ends_the_run(examples, window):
    from stiffmbs.show.figure import show_live

    asked = []

    def solutions():
        for solution in stiffmbs.follow(examples / "cart_pendulum.yaml", every=0.0, duration=0.3):
            asked.append(solution)
            if len(asked) == 2:
                window.close("all")
            yield solution

    show_live(solutions(), (), "time")
    assert len(asked) == 2
