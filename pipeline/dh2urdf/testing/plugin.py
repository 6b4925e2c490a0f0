"""Fixtures for the tests of plugins: pytest finds them wherever dh2urdf is installed.

This module is imported in every run of pytest on such a machine, whatever is tested: it imports what it gives only
where a test asks for it, and its fixtures bear the project's name.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.testing.catalogs import RunOutput


@pytest.fixture
def dh2urdf_catalog() -> Callable[..., Catalog]:
    """Makes a catalog of some stages and of nothing else: ``dh2urdf_catalog(READER, EMITTER)``."""
    from dh2urdf.testing.catalogs import catalog_of

    return catalog_of


@pytest.fixture
def dh2urdf_manipulators() -> tuple[Manipulator, ...]:
    """Reference arms: both conventions, all joint types, offsets, negative signs, a base and a tool."""
    from dh2urdf.testing.reference import reference_manipulators

    return reference_manipulators()


@pytest.fixture
def dh2urdf_robots(dh2urdf_manipulators: tuple[Manipulator, ...]) -> tuple[Robot, ...]:
    """The robots of the reference arms."""
    from dh2urdf.testing.reference import plain_robot

    return tuple(map(plain_robot, dh2urdf_manipulators))


@pytest.fixture
def dh2urdf_run(tmp_path: Path) -> Callable[..., RunOutput]:
    """Does a run in a temporary folder: ``dh2urdf_run("inputs: arm.csv", {"arm.csv": "…"})``."""
    from dh2urdf.testing.catalogs import do_run

    return partial(do_run, tmp_path)
