"""What the world does: scenes and doors as they truly are, the robot, and its sensors."""
