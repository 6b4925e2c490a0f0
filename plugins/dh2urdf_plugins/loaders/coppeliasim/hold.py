"""The hold test in CoppeliaSim, by an engine of its own: the arm as it was imported, its joints held where they are.

CoppeliaSim moves an imported joint by its own position control, with the effort of the file as the largest torque. It
makes no engine's absence known: without one the arm just stands still, so that it is asked whether it moves at all. And
an engine may let joints come apart, while they report small displacements: what counts besides is where the tips are.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.source import shown
from dh2urdf_plugins.loaders.measures import HOLD_SECONDS, HOLD_STAYS, hold_start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem
    from dh2urdf_plugins.loaders.coppeliasim.arm import Arm
    from dh2urdf_plugins.loaders.coppeliasim.engines import Engine

_STOPS_WITHIN = 30.0
"""How long CoppeliaSim may take to stop a simulation [s]."""


def hold(arm: Arm, engine: Engine) -> tuple[dict[str, Any], tuple[Problem, ...]]:
    """Has the arm hold itself for two seconds, and puts the scene back as it was.

    Args:
        arm: the imported arm.
        engine: the engine that computes its motion.

    Returns:
        The test as a report has it, and its findings.

    Raises:
        LoaderError: this CoppeliaSim has no such engine.
    """
    ask, sim, start = arm.ask, arm.sim, hold_start(arm.robot)
    before = ask(sim.getInt32Param, sim.intparam_dynamic_engine)
    ask(sim.setInt32Param, sim.intparam_dynamic_engine, getattr(sim, f"physics_{engine}"))
    ask(sim.setStepping, True)
    try:
        arm.put(start)
        for joint, value in zip(arm.robot.moving_joints, start, strict=True):
            ask(sim.setJointTargetPosition, arm.joints[joint.name], float(value))
        ask(sim.startSimulation)
        displacement, apart = _watched(arm, engine, start)
    finally:
        if not arm.connection.lost:
            _stop(arm)
            ask(sim.setStepping, False)
            ask(sim.setInt32Param, sim.intparam_dynamic_engine, before)
    record, findings = arm.comparison.hold(start, displacement, ())
    tip, distance = max(apart.items(), key=lambda item: item[1])
    if not distance <= HOLD_STAYS:
        record["stayed"] = False
        findings = (
            *findings,
            arm.comparison.problem(
                message=f"the engine {engine} of CoppeliaSim lets joints come apart: in {HOLD_SECONDS:g} s "
                f"{shown(tip)} got {distance:.3g} m away from where the joints say that it is",
                severity="notice",
                suggestion="simulate with another engine: with MuJoCo arms were seen to hold together",
            ),
        )
    return record, findings


def _watched(arm: Arm, engine: Engine, start: Sequence[float]) -> tuple[list[float], dict[str, float]]:
    """How far each joint was from its start at most [rad or m], and each tip from where the joints put it [m]."""
    ask, sim = arm.ask, arm.sim
    displacement = [0.0] * len(start)
    apart = dict.fromkeys(arm.request.expected, 0.0)
    first = True
    while ask(sim.getSimulationTime) < HOLD_SECONDS:
        ask(sim.step)
        if first and not any(ask(sim.isDynamicallyEnabled, handle) for handle in arm.joints.values()):
            raise LoaderError(
                f"this CoppeliaSim has no engine {engine}, or does not move the arm with it: nothing of it is simulated"
            )
        first = False
        q = [ask(sim.getJointPosition, arm.joints[joint.name]) for joint in arm.robot.moving_joints]
        displacement = [max(most, _size(now - was)) for most, now, was in zip(displacement, q, start, strict=True)]
        told, held = arm.told_frames(q), arm.held_frames(tuple(apart))
        apart = {tip: max(most, _distance(told, held, tip)) for tip, most in apart.items()}
    return displacement, apart


def _distance(told: Mapping[str, RigidTransform], held: Mapping[str, RigidTransform], tip: str) -> float:
    return _size(math.dist(told[tip].translation, held[tip].translation))


def _size(value: float) -> float:
    """The size of a number; of none at all it is infinite."""
    return abs(value) if math.isfinite(value) else math.inf


def _stop(arm: Arm) -> None:
    """Stops the simulation, which puts everything back where it was.

    Raises:
        LoaderError: it does not stop.
    """
    ask, sim = arm.ask, arm.sim
    ask(sim.stopSimulation)
    deadline = time.monotonic() + _STOPS_WITHIN
    while ask(sim.getSimulationState) != sim.simulation_stopped:
        if time.monotonic() > deadline:
            raise LoaderError(f"CoppeliaSim does not stop its simulation within {_STOPS_WITHIN:g} s")
        time.sleep(0.01)
