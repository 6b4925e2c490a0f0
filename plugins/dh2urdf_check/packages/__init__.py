"""The rules of `dh2urdf check` about whole packages of ROS 2: what no single file shows."""
