"""The records of a robot, and rows of tables, without their checks, for stages that have computed the values.

Each function takes what the class of the same name takes, and keeps it as it is: a float has to be a float, and a
vector a tuple of floats. Whatever somebody else handed over belongs into the class, which checks it. `changed` is
`dataclasses.replace` without checks, for the records of a table too: columns of numbers stay as they are.
"""

from __future__ import annotations

from dh2urdf.manipulator import DHRow, Inertia, Limits
from dh2urdf.record_fields import replace_unchecked, unchecked
from dh2urdf.robot import Collision, Inertial, Joint, Link, Origin, Parameter, Visual

changed = replace_unchecked
collision = unchecked(Collision)
dh_row = unchecked(DHRow)
inertia = unchecked(Inertia)
inertial = unchecked(Inertial)
joint = unchecked(Joint)
limits = unchecked(Limits)
link = unchecked(Link)
origin = unchecked(Origin)
parameter = unchecked(Parameter)
visual = unchecked(Visual)
