from __future__ import annotations

import subprocess
import sys

import pytest

pytest.importorskip("nicegui")

from dh2urdf_studio import app


class Shown:
    """What a tab shows, counted."""

    def __init__(self, origin: Shown | None = None) -> None:
        self.origin = origin

    def copy(self) -> Shown:
        return Shown(self)


@pytest.fixture
def sessions() -> app.Sessions[Shown]:
    return app.Sessions(Shown)


def test_a_tab_finds_its_own_again(sessions: app.Sessions[Shown]) -> None:
    """The same tab gets the same, another one something new."""
    one = sessions.of("one")
    assert sessions.of("two") is not one
    assert sessions.of("one", "one") is one


def test_a_duplicated_tab_goes_on_from_a_copy(sessions: app.Sessions[Shown]) -> None:
    """A browser copies a tab's storage with the tab: the copy shows the same, and is a session of its own."""
    one = sessions.of("one")
    copied = sessions.of("two", "one")
    assert copied is not one
    assert copied.origin is one


def test_the_oldest_tab_goes_first(sessions: app.Sessions[Shown], monkeypatch: pytest.MonkeyPatch) -> None:
    """Only so many are kept; one that was used lately stays."""
    monkeypatch.setattr(app, "MOST_SESSIONS", 2)
    one, two = sessions.of("one"), sessions.of("two")
    sessions.of("one")
    sessions.of("three")
    assert sessions.of("one") is one
    assert sessions.of("two") is not two


def test_the_first_arm_waits_for_no_import() -> None:
    """What is imported for an arm is imported when the studio starts, and not at the first key."""
    code = """
import sys
from dh2urdf.plugin_system.catalog import load
from dh2urdf_studio import app
from dh2urdf_studio.editing.session import Session
from dh2urdf.table_text import TableText
catalog = load()
app.rehearse(catalog)
session, before = Session(catalog), set(sys.modules)
session.put(TableText(name="a", convention="modified", rows=({"a": "0.1", "alpha": "pi/2", "d": "0"},)))
session.preview(0, "a", "0.2")
assert session.pose is not None
assert sorted(set(sys.modules) - before) == []
"""
    subprocess.run([sys.executable, "-c", code], check=True)
