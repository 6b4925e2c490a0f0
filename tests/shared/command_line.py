"""What a test gets that calls the command line in its own process."""

from collections.abc import Callable
from typing import NamedTuple


class Answer(NamedTuple):
    """What the command line printed."""

    stdout: str
    stderr: str


Cli = Callable[..., Answer]
"""Calls the command line with words, and checks its exit status: the fixture `cli`."""
