from __future__ import annotations

import pytest

pytest.importorskip("nicegui")

from dh2urdf_studio import app


class Shown:
    """What a tab shows."""


@pytest.fixture
def sessions() -> app.Sessions[Shown]:
    return app.Sessions(Shown)


def test_a_tab_finds_its_own_again(sessions: app.Sessions[Shown]) -> None:
    """The same tab gets the same, another one something new."""
    one = sessions.of("one")
    assert sessions.of("two") is not one
    assert sessions.of("one") is one


def test_the_oldest_tab_goes_first(sessions: app.Sessions[Shown], monkeypatch: pytest.MonkeyPatch) -> None:
    """Only so many are kept; one that was used lately stays."""
    monkeypatch.setattr(app, "MOST_SESSIONS", 2)
    one, two = sessions.of("one"), sessions.of("two")
    sessions.of("one")
    sessions.of("three")
    assert sessions.of("one") is one
    assert sessions.of("two") is not two
