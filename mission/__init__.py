"""What the robot does: missions that scan rooms and find doors, their command line and their recordings."""
