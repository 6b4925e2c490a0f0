"""Both stages keep the contracts of dh2urdf."""

from __future__ import annotations

from pathlib import Path

from dh2urdf_example_plugin.emitter import EMITTER, DatasheetOptions
from dh2urdf_example_plugin.reader import READER

from dh2urdf.testing import EmitterContract, ReaderContract

SCARA = Path(__file__).parents[1] / "examples" / "scara.dh.toml"


class TestReader(ReaderContract):
    stage = READER
    example = SCARA.read_bytes()


class TestEmitter(EmitterContract):
    stage = EMITTER


class TestEmitterInRadians(EmitterContract):
    stage = EMITTER
    options = DatasheetOptions(angles="rad", digits=3)
