"""Where Drake has the links and frames of an SDF: what the reader of SDF is held against."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest


def drake_plant(path: Path) -> Any:
    """What Drake makes of a file."""
    pytest.importorskip("pydrake")
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.001)
    Parser(plant).AddModels(str(path))
    plant.Finalize()
    return plant


def drake_frames(path: Path) -> Any:
    """T(world → frame) by Drake, as a function of the joint values and the frame's name."""
    plant = drake_plant(path)
    context = plant.CreateDefaultContext()

    def frame(values: dict[str, float], name: str) -> np.ndarray:
        for joint, value in values.items():
            plant.SetPositions(context, joint_vector(plant, context, joint, value))
        inner, _, own = name.rpartition("::")
        named = (own, plant.GetModelInstanceByName(f"m::{inner}")) if inner else (name,)
        return np.array(plant.GetFrameByName(*named).CalcPoseInWorld(context).GetAsMatrix4())

    return frame


def joint_vector(plant: Any, context: Any, joint: str, value: float) -> Any:
    q = plant.GetPositions(context)
    q[plant.GetJointByName(joint).position_start()] = value
    return q
