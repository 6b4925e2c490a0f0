"""Any table, as a file, against the DH product: what the whole chain from text to text has to keep."""

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from any_tables import SEEN_LENGTHS, manipulators
from hypothesis import given, settings, strategies as st

from dh2urdf.conversion.one_manipulator import Call, Recipe, read_items, write_robot
from dh2urdf.conversion.robots import make_robot
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.plugin_system.options import make_options
from dh2urdf.testing.oracle import table_pose

FRAMES = ("aligned", "dh")
CATALOG = load()


@pytest.mark.long
@given(
    manipulator=manipulators(lengths=SEEN_LENGTHS, limits=True),
    form=st.sampled_from(["csv", "yaml"]),
    units=st.tuples(st.sampled_from(["m", "mm"]), st.sampled_from(["rad", "deg"])),
    seed=st.integers(0, 99),
)
@settings(max_examples=100)
def test_the_file_of_a_table_file_is_its_arm_in_both_frames(
    *,
    tool0_of: Callable[[Path], Callable[[Sequence[float]], np.ndarray]],
    as_table: Callable[..., str],
    manipulator: Manipulator,
    form: str,
    units: tuple[str, str],
    seed: int,
) -> None:
    """Whatever a table says, in whatever units: the URDF of either frames puts tool0 where the DH product has it."""
    draw = np.random.default_rng(seed)
    vectors = [np.zeros(len(manipulator.actuated_rows)), *draw.uniform(-7, 7, (4, len(manipulator.actuated_rows)))]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / f"arm.{form}").write_text(as_table(manipulator, form, units=units), "utf-8")
        for frames in FRAMES:
            pose = tool0_of(convert(folder / f"arm.{form}", frames))
            for q in vectors:
                np.testing.assert_allclose(pose(q), table_pose(manipulator, q), rtol=0, atol=1e-9)


def convert(table: Path, frames: str) -> Path:
    """The URDF of a table file: read, transformed, checked, emitted, proved and put in place."""
    reader = CATALOG.reader_for(table)
    swap = CATALOG.get("transform", "alpha-swap")
    urdf = CATALOG.get("emitter", "urdf")
    recipe = Recipe(
        transform=Call(stage=swap, options=make_options(swap.options, {"frames": frames}, where="test")),
        emitters=(Call(stage=urdf, options=urdf.options()),),
        poses=1,
    )
    (manipulator,) = read_items(Call(stage=reader, options=reader.options()), table)
    assert isinstance(manipulator, Manipulator)
    robot = make_robot(manipulator, recipe.transform)
    write_robot(ExpectedPoses.of(manipulator), robot, recipe, directory=table.parent, stem=frames)
    return table.parent / f"{frames}.urdf"
