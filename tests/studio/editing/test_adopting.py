"""The numbers of a description, taken into the table."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

import dh2urdf
from dh2urdf_studio.editing.comparing import GivenFiles, adopted, changed_cells, own_table
from dh2urdf_studio.editing.edits import with_cells
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import Catalog


@pytest.mark.parametrize(
    ("file", "cells", "ends", "most"),
    [
        ("ur5.csv", {(0, "d"): "0.092"}, {}, 1),
        ("ur5.csv", {(1, "a"): "-0.43", (3, "alpha"): "1.6", (5, "theta"): "0.25"}, {}, 3),
        ("ur5.csv", {(2, "sign"): "-1", (2, "theta"): "0.5"}, {}, 2),
        ("panda.yaml", {(3, "a"): "0.09"}, {}, 1),  # of eight rows, of which its own table has seven
        ("panda.yaml", {}, {"base": "{xyz: [0.1, 0, 0], rpy: [0, 0, 0.3]}", "tool": "{xyz: [0, 0, 0.2]}"}, 3),
        ("stanford.csv", {(2, "d"): "0.1", (4, "alpha"): "1.5"}, {}, 2),
    ],
)
def test_the_table_becomes_the_description(catalog: Catalog, file: str, cells: dict, ends: dict, most: int) -> None:
    """Of an arm that differs in a few numbers only these are taken; the other cells keep their texts."""
    table = gallery_table(file, catalog)
    other = replace(with_cells(table, cells), **ends)
    described = Session(catalog, other).arm
    assert described
    text = dh2urdf.convert(described.manipulator).text
    session = Session(catalog, table)
    files = GivenFiles([("other.urdf", text.encode())], catalog)
    figure = files.figure("other.urdf")
    assert not isinstance(figure, str)
    session.lay_beside(figure)
    found, arm = session.beside, session.arm
    assert arm
    assert found
    assert found.agreement
    assert not found.agreement.holds
    ends = found.agreement.base_link, found.agreement.tip_link
    own = own_table(files.path("other.urdf"), catalog, arm.manipulator, ends)
    taken = adopted(table, arm.manipulator, found, own, catalog)
    assert taken
    assert 0 < changed_cells(table, taken) <= most
    session.put(taken)
    assert session.beside
    assert session.beside.agreement
    assert session.beside.agreement.holds
    session.undo()
    assert session.table == table
    files.close()
