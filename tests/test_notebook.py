"""The notebook among the pages runs, and its objects show themselves."""

from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
GUIDE = Path(__file__).parent.parent / "docs" / "guide"


@pytest.mark.long
def test_the_notebook_runs_and_shows_tables_and_pictures():
    notebook = nbformat.read(GUIDE / "notebook.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(GUIDE)}}).execute()
    shown = [output["data"] for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    tables = [data["text/html"] for data in shown if "text/html" in data]
    assert len(tables) >= 6
    assert sum("<img" in table for table in tables) == 2  # the model's drawing, and the figure of the solution
    assert sum("image/png" in data for data in shown) == 2
