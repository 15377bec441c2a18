"""Searches for equilibria that there are not."""

from dataclasses import replace

import pytest

from stiffmbs.equilibria import equilibrium
from stiffmbs.tuning import parameters_of


@pytest.fixture
def few_moves(monkeypatch):
    """A search is given up after a tenth of its moves."""
    monkeypatch.setattr(equilibrium, "EQUILIBRIA", replace(parameters_of(equilibrium.EQUILIBRIA), most_moves=200))
