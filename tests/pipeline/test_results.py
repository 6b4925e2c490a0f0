"""The types of plain data, of which the JSON Schemas are made; other tests compare what is printed with the schemas."""

from __future__ import annotations

import subprocess
import sys
from typing import get_args, get_type_hints

from dh2urdf import results
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.plugin_system import KINDS
from dh2urdf.report.conversions import FILLED_IN


def test_names_are_those_of_the_records() -> None:
    """The words for conventions, joint types, kinds of stages, and what a conversion may fill in."""
    assert get_args(results.ConventionName) == tuple(Convention)
    assert get_args(results.JointTypeName) == tuple(JointType)
    assert get_args(results.KindName) == KINDS
    assert list(get_type_hints(results.FilledInEntry)) == [words.replace(" ", "_") for words in FILLED_IN]


def test_importing_dh2urdf_does_not_import_them() -> None:
    """They are there for type checkers, and for those who ask."""
    code = "import sys, dh2urdf; dh2urdf.read; dh2urdf.run; print('dh2urdf.results' in sys.modules); dh2urdf.results"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["False"]
