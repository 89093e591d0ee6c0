"""The planners benchmark: scans, metres and coverage of the next best scan beside those of its baselines."""
