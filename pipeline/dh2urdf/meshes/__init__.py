"""Mesh files: where tables find them, how descriptions name them, and the forms that simulators take."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.meshes.addresses import (
        FILE as FILE,
        PACKAGE as PACKAGE,
        file_address as file_address,
        mesh_finder as mesh_finder,
        own_folder as own_folder,
        packages_in as packages_in,
        path_of_address as path_of_address,
        with_its_own as with_its_own,
    )
    from dh2urdf.meshes.files import (
        REMEDY as REMEDY,
        copy_name as copy_name,
        find_mesh as find_mesh,
        has_meshes as has_meshes,
        read_mesh as read_mesh,
        with_addresses as with_addresses,
        with_its_files as with_its_files,
        with_shapes as with_shapes,
    )
    from dh2urdf.meshes.triangles import (
        FORMATS as FORMATS,
        Asset as Asset,
        asset_of as asset_of,
        enclosed as enclosed,
        load_scene as load_scene,
        read_parts as read_parts,
        to_metres as to_metres,
    )
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "addresses": "FILE PACKAGE file_address mesh_finder own_folder packages_in path_of_address with_its_own",
            "files": "REMEDY copy_name find_mesh has_meshes read_mesh with_addresses with_its_files with_shapes",
            "triangles": "Asset FORMATS asset_of enclosed load_scene read_parts to_metres",
        },
    )
