"""Reads written files back, for the proof: by code that shares nothing with what wrote them.

The functions here are those that the records of emitters name.
"""

from __future__ import annotations

from dh2urdf_plugins.late import Late

read_urdf = Late(f"{__name__}.urdf_reader:read_urdf")
read_urdfs = Late(f"{__name__}.urdf_scanner:scan_columns")
read_xacro = Late(f"{__name__}.xacro_reader:read_xacro")
read_foreign_xacro = Late(f"{__name__}.xacro_reader:read_foreign_xacro")
read_sdf = Late(f"{__name__}.sdf.reader:read_sdf")
read_mjcf = Late(f"{__name__}.mjcf.reader:read_mjcf")
read_table = Late(f"{__name__}.table_reader:read_table")
