"""What a third party's code raises, in words: it may raise anything, and even the text of that may fail."""

from __future__ import annotations


def reason_of(error: BaseException) -> str:
    """The class of an exception and its message, in one line."""
    try:
        text = str(error)
    except Exception as failed:  # noqa: BLE001 - it is the exception's own code
        text = f"its text cannot be made: {type(failed).__name__}"
    text = "; ".join(filter(None, map(str.strip, text.removeprefix("error: ").splitlines())))
    return f"{type(error).__name__}: {text}" if text else f"{type(error).__name__}, without a message"


def traceback_of(error: BaseException) -> str:
    """Where an exception was raised, for `--debug`."""
    import traceback

    return "".join(traceback.format_exception(error))
