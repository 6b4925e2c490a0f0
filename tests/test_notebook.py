"""The notebooks of docs/notebooks run, and show what is kept in their files. `pytest --renew` runs and writes them."""

import json
import re
from typing import Any

import pytest

import notebook_pages

NOTEBOOKS = sorted(notebook_pages.FOLDER.glob("*.ipynb"))


def comparable(notebook: dict[str, Any]) -> str:
    """A notebook without its drawings, which every version of matplotlib writes a little differently."""
    return re.sub(r"<figure>.*?</figure>", "<figure/>", json.dumps(notebook, ensure_ascii=False))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_shows_what_its_cells_give(path: Any, *, renew: bool) -> None:
    """Every code cell is run in order; what it prints, and how its last value is shown, is in the file."""
    pytest.importorskip("matplotlib")
    kept = json.loads(path.read_text("utf-8"))
    fresh = notebook_pages.executed(kept)
    if renew:
        path.write_text(json.dumps(fresh, indent=1, ensure_ascii=False) + "\n", "utf-8")
        kept = fresh
    assert "<figure>" in json.dumps(kept)
    assert comparable(kept) == comparable(fresh), "run `pytest --renew tests/test_notebook.py`"


def test_a_cell_that_fails_fails_the_test() -> None:
    """What a cell raises is raised; a value that changes is another output."""
    cell = {"cell_type": "code", "metadata": {}, "execution_count": None, "outputs": [], "source": ["1 / 0"]}
    with pytest.raises(ZeroDivisionError):
        notebook_pages.executed({"cells": [cell]})
    first, second = (notebook_pages.executed({"cells": [{**cell, "source": [text]}]}) for text in ("2 + 2", "2 + 3"))
    assert comparable(first) != comparable(second)


def test_the_page_has_all_cells() -> None:
    """The site shows the code and the outputs of each notebook."""
    for path in NOTEBOOKS:
        page = notebook_pages.page(path.stem)
        for cell in json.loads(path.read_text("utf-8"))["cells"]:
            assert "".join(cell["source"]) in page
        assert page.count('<div class="dh2urdf">') > 0
        assert page.count('```text title="Output"') > 0
