"""A row of a table that says all that a row can say in numbers."""

from dh2urdf.manipulator import DHRow, Inertia, Limits

INERTIA = Inertia(ixx=0.02, iyy=0.03, izz=0.025, ixy=0.001, ixz=0.002, iyz=0.003)
FULL_ROW = DHRow(
    joint="shoulder",
    link="upper_arm",
    a=0.4,
    alpha=0.3,
    d=0.2,
    theta=0.1,
    offset=0.05,
    limits=Limits(lower=-1.0, upper=3.0, velocity=2.0, effort=50.0),
    mass=3.0,
    com=(0.01, 0.02, 0.03),
    inertia=INERTIA,
    radius=0.04,
    damping=0.5,
    friction=0.4,
    armature=0.1,
)
