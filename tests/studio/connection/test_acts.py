from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from dh2urdf_studio.app import Arrivals


@pytest.fixture
def arrivals() -> Arrivals:
    pytest.importorskip("nicegui")
    from dh2urdf_studio.app import Arrivals

    return Arrivals()


def test_an_act_is_new_once(arrivals: Arrivals) -> None:
    """An act that arrives again, over another connection or behind a later one, is known; each page counts its own."""
    assert [arrivals.take("one", number) for number in (1, 2, 1, 2, 3)] == [True, True, False, False, True]
    assert arrivals.take("other", 1)
    assert arrivals.take("one", 3) is False


def test_an_act_does_not_overtake_another(arrivals: Arrivals) -> None:
    """What is done while a lost act is on its way again waits for it, and is done after it."""
    assert [arrivals.take("page", number) for number in (1, 3, 2, 3)] == [True, None, True, True]


def test_what_has_not_arrived_is_lost(arrivals: Arrivals) -> None:
    """Of the acts that a page has had no answer to, those are lost whose number is above the last one that arrived."""
    arrivals.take("page", 1)
    assert arrivals.lost("page", [(1, "row 1, a: 2"), (2, "undo")]) == ["undo"]
    assert arrivals.lost("a page of a server before", [(7, "redo")]) == ["redo"]


def test_pages_that_are_gone_are_forgotten(arrivals: Arrivals, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the pages that are gone, the one that was not heard of for the longest time goes first; those that are there stay."""
    from nicegui import Client

    monkeypatch.setattr("dh2urdf_studio.app.MOST_PAGES", 3)
    monkeypatch.setitem(Client.instances, "there", None)
    for page in ("there", "one", "two", "one", "three"):
        arrivals.take(page, 1)
    assert [arrivals.take(page, 1) for page in ("there", "one", "three", "two")] == [False, False, False, True]
