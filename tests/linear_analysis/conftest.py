"""Searches for equilibria that there are not."""

import pytest


@pytest.fixture
def few_moves(monkeypatch):
    """A search is given up after a tenth of its moves."""
    monkeypatch.setattr("stiffmbs.equilibria.equilibrium.MOST_MOVES", 200)
