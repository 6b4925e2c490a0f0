from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from dh2urdf.studio.connection.acts import Arrivals


@pytest.fixture
def arrivals() -> Arrivals:
    pytest.importorskip("nicegui")
    from dh2urdf.studio.connection.acts import Arrivals

    return Arrivals()


def test_an_act_is_new_once(arrivals: Arrivals) -> None:
    """An act that arrives again, over another connection or behind a later one, is known; each page counts its own."""
    assert [arrivals.is_new("one", number) for number in (1, 2, 1, 2, 3)] == [True, True, False, False, True]
    assert arrivals.is_new("other", 1)
    assert not arrivals.is_new("one", 3)


def test_what_has_not_arrived_is_lost(arrivals: Arrivals) -> None:
    """Of the acts that a page has had no answer to, those are lost whose number is above the last one that arrived."""
    arrivals.is_new("page", 1)
    assert arrivals.lost("page", [(1, "row 1, a: 2"), (2, "undo")]) == ["undo"]
    assert arrivals.lost("a page of a server before", [(7, "redo")]) == ["redo"]


def test_pages_that_are_gone_are_forgotten(arrivals: Arrivals, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page that was not heard of for the longest time goes first."""
    monkeypatch.setattr("dh2urdf.studio.connection.acts.MOST_PAGES", 2)
    for page in ("one", "two", "one", "three"):
        arrivals.is_new(page, 1)
    assert [arrivals.is_new(page, 1) for page in ("one", "three", "two")] == [False, False, True]
