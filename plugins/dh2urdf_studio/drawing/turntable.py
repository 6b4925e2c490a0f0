"""A turn about the arm as an animated GIF, of the frames that the page has drawn.

A GIF and no WebM: a browser records a WebM in real time, so that a slow graphics card drops frames, and what Chromium
records has no length and cannot be wound back. A GIF has exactly the frames that were drawn, and slides, mails and
README files play it.
"""

from __future__ import annotations

import base64
import binascii
import io
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError, pip_install
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

FRAMES = 36
"""Frames of a turn."""
LARGEST = 640
"""The longer side of a frame [px]."""
_SHOWN = 80  # for this long [ms]
_SAMPLES = 6  # frames whose colours the palette is made of
_PREFIX = "data:image/png;base64,"


def gif(frames: Sequence[str]) -> bytes:
    """An endless animation.

    Args:
        frames: pictures of one size, as the page sends them: PNG in data addresses.

    Raises:
        OutputError: they are no such pictures, or Pillow is not installed.
    """
    try:
        from PIL import Image
    except ImportError as error:
        remedy = f"install Pillow: {pip_install('dh2urdf[studio]')}"
        raise OutputError(
            Problem(message="a turntable needs Pillow, which is not installed", suggestion=remedy)
        ) from error
    pictures: list[Image.Image] = []
    for frame in frames:
        try:
            content = base64.b64decode(frame.removeprefix(_PREFIX), validate=True)
            opened = Image.open(io.BytesIO(content), formats=["PNG"])
            if max(opened.size) > LARGEST or (pictures and opened.size != pictures[0].size):
                raise ValueError(f"its size is {opened.size}")
            pictures.append(opened.convert("RGB"))
        except (binascii.Error, OSError, ValueError, Image.DecompressionBombError) as error:
            raise OutputError(
                Problem(message=f"frame {len(pictures) + 1} of the turn is no picture: {error}")
            ) from error
    width, height = pictures[0].size
    samples = pictures[:: max(1, len(pictures) // _SAMPLES)]
    sheet = Image.new("RGB", (width, height * len(samples)))
    for number, picture in enumerate(samples):
        sheet.paste(picture, (0, height * number))
    palette = sheet.quantize(256, method=Image.Quantize.MEDIANCUT)  # one for all: colours do not flicker
    first, *others = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    written = io.BytesIO()
    first.save(written, "GIF", save_all=True, append_images=others, duration=_SHOWN, loop=0, optimize=False)
    return written.getvalue()
