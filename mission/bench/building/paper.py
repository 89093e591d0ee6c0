"""What the paper reports of its simulated building: Table 3 (Quintana, Prieto, Adan, Bosche, section 7.3)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PaperFace:
    """A row of Table 3: one door as it was seen from one room."""

    name: str
    true_angle_deg: float
    """Of the door in building.xml that stands like it; the paper has no true angles, but two rows a door."""
    angle_deg: float
    """As the paper measured it."""
    precision: float
    recall: float
    e_abs: float
    """[m2]"""
    e_rel: float


TABLE_3 = (
    PaperFace("#1", 35.0, 34.96, 0.993, 0.989, 0.035, 0.017),
    PaperFace("#2", 3.0, 2.25, 0.990, 0.991, 0.065, 0.018),
    PaperFace("#3", 54.0, 52.72, 0.953, 0.953, 0.239, 0.092),
    PaperFace("#4", 0.0, 0.0, 0.987, 0.983, 0.058, 0.028),
    PaperFace("#5", 3.0, 3.54, 0.995, 0.986, 0.045, 0.017),
    PaperFace("#6", 0.0, 0.0, 0.987, 0.987, 0.066, 0.025),
    PaperFace("#7", 54.0, 55.64, 0.990, 0.982, 0.069, 0.026),
    PaperFace("#8", 0.0, 0.0, 0.987, 0.986, 0.067, 0.026),
    PaperFace("#9", 0.0, 0.35, 0.994, 0.986, 0.049, 0.018),
)
MEAN = {"precision": 0.986, "recall": 0.983, "e_abs": 0.077, "e_rel": 0.030}
"""As the paper has it."""
FALSE_POSITIVES = 1
