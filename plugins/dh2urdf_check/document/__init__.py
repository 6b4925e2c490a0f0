"""Robot descriptions as they are in the file: elements with their places, links and joints, sizes of meshes."""
