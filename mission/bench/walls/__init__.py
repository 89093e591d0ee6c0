"""The walls benchmark: 35 doors in 27 generated walls, found by the detector and judged against the truth."""
