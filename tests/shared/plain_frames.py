"""Frames as 4 × 4 matrices of numpy: what frames, DH products and inertias of the project are compared with."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


def turn(axis: str | Sequence[float], angle: float) -> Matrix:
    """The rotation about x, y, z or a unit vector, by Rodrigues' formula."""
    x, y, z = np.eye(3)["xyz".index(axis)] if isinstance(axis, str) else axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return matrix


def shift(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Matrix:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def rpy(roll: float, pitch: float, yaw: float) -> Matrix:
    """The rotation of a URDF: about fixed axes."""
    return turn("z", yaw) @ turn("y", pitch) @ turn("x", roll)


def dh(convention: str, theta: float, d: float, a: float, alpha: float) -> Matrix:
    """A row: Rz(θ) Tz(d) Tx(a) Rx(α) of Denavit and Hartenberg, 1955, or Rx(α) Tx(a) Rz(θ) Tz(d) of Craig."""
    about_z, about_x = turn("z", theta) @ shift(z=d), shift(x=a) @ turn("x", alpha)
    return about_z @ about_x if convention == "standard" else about_x @ about_z


def homogeneous(transform: Any) -> Matrix:
    matrix = shift(*transform.translation)
    matrix[:3, :3] = np.reshape(transform.rotation, (3, 3))
    return matrix


def tensor(inertia: Any) -> Matrix:
    i = inertia
    return np.array([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])
