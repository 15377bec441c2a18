"""Reader of tyre property files for the tests of this folder."""

import pytest

from stiffmbs.elements.tyres.coefficients import TyreProperties


@pytest.fixture
def read(tmp_path):
    """Return a function that writes a text to ``front.tir`` and reads it."""

    def reader(text, encoding="utf-8"):
        (tmp_path / "front.tir").write_bytes(text.encode(encoding))
        return TyreProperties.from_file(tmp_path / "front.tir")

    return reader
