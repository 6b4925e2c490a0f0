"""The emitter `ros2`: packages that a ROS 2 workspace builds as they are."""
