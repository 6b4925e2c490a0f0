"""Frames as an animation. A whole turn is in tests/studio/panels/test_sharing.py."""

from __future__ import annotations

import base64
import io

import pytest
from PIL import Image

from dh2urdf.errors import OutputError
from dh2urdf_studio.drawing.exports import LARGEST, gif


def frame(size: tuple[int, int], colour: tuple[int, int, int], kind: str = "PNG") -> str:
    written = io.BytesIO()
    Image.new("RGB", size, colour).save(written, kind)
    return "data:image/png;base64," + base64.b64encode(written.getvalue()).decode()


def test_frames_keep_their_order_and_colours() -> None:
    colours = [(250 - 40 * number, 30 * number, 40) for number in range(6)]
    made = Image.open(io.BytesIO(gif([frame((20, 10), colour) for colour in colours])))
    for number, colour in enumerate(colours):
        made.seek(number)
        assert made.size == (20, 10)
        found = made.convert("RGB").getpixel((5, 5))
        assert isinstance(found, tuple)
        assert max(abs(one - other) for one, other in zip(found, colour, strict=True)) < 3


@pytest.mark.parametrize(
    "second",
    [
        "",
        "data:image/png;base64,!",
        "data:image/png;base64,aaaa",
        frame((9, 9), (0, 0, 0), "JPEG"),
        frame((9, 8), (0, 0, 0)),
    ],
    ids=["empty", "no base64", "no picture", "a JPEG", "another size"],
)
def test_what_is_no_frame_is_refused(second: str) -> None:
    with pytest.raises(OutputError, match="frame 2 of the turn is no picture"):
        gif([frame((9, 9), (1, 2, 3)), second])


def test_frames_have_a_largest_size() -> None:
    with pytest.raises(OutputError, match=f"its size is \\({LARGEST + 1}, 2\\)"):
        gif([frame((LARGEST + 1, 2), (1, 2, 3))])
