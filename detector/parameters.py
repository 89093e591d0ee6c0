"""Every number of the detector with its unit and source (section 8 of the paper)."""

from __future__ import annotations

from math import pi
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class DetectorParameters(BaseModel):
    """Parameters of all stages; the defaults are the paper's wherever it gives a number."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    # Section 4: orthoimages
    pixel_size: float = Field(0.005, gt=0, le=0.1, description="side of a pixel [m]; section 4")
    max_pixels: int = Field(
        20_000_000, gt=0, le=1_000_000_000, description="largest orthoimage that is accepted; ours, bounds the memory"
    )
    slab_front: float = Field(0.20, gt=0, le=1, description="what stands out further is no wall data [m]; voxel side")
    slab_behind: float = Field(0.25, gt=0, le=1, description="how deep a closed leaf may be recessed [m]; ours")
    face_tolerance: float = Field(
        0.03,
        gt=0,
        le=0.1,
        description="a point within this of the plane is on the wall's face [m]; 10 sigma of a VZ-400",
    )
    slab_face: float = Field(
        0.045, gt=0, le=0.2, description="the wall with frames and skirting lies within this of its plane [m]; ours"
    )
    floor_margin: float = Field(
        0.015, ge=0, le=0.2, description="strip over the floor that holds floor points [m]; ours"
    )
    max_gap_px: int = Field(9, ge=1, le=51, description="widest gap between samples that is closed [px]; ours")

    # Sections 4.1 and 4.2: highlights and merging
    correct_highlights: bool = Field(True, description="False skips section 4.1, as in Table 5")
    normalise_flash: bool = Field(True, description="divide a view by its fitted flash fall-off before merging; ours")
    compare_views: bool = Field(True, description="False looks for highlights in one view at a time, as section 4.1")
    grey_levels: int = Field(11, ge=2, le=64, description="levels of the quantised intensity; section 4.1")
    highlight_roi_angle: float = Field(
        0.6, gt=0, le=1.5, description="incidence that bounds the region of interest [rad]"
    )
    highlight_mirror_angle: float = Field(
        0.1, gt=0, le=1.5, description="incidence within which a flat wall mirrors a flash beside the lens [rad]; ours"
    )
    min_highlight_area: float = Field(8e-4, gt=0, le=1, description="smallest highlight [m2]; section 7.4")
    min_highlight_contrast: float = Field(
        0.06, gt=0, le=1, description="least height of a highlight over its foot; ours"
    )
    min_gloss_contrast: float = Field(
        0.035, gt=0, le=1, description="least height of a highlight over what other views see there; ours"
    )
    highlight_r2: float = Field(0.9, gt=0, le=1, description="share of variance that the Gaussian must explain; ours")
    w1_mean: float = Field(0.0, ge=0, le=1.6, description="mean of w1 [rad]; section 4.2")
    w1_std: float = Field(pi / 9, gt=0, le=1.6, description="standard deviation of w1 [rad]; section 4.2")
    w2_mean: float = Field(pi / 9, ge=0, le=1.6, description="mean of w2, used on highlights [rad]; section 4.2")
    w2_std: float = Field(pi / 6, gt=0, le=1.6, description="standard deviation of w2 [rad]; section 4.2")

    # Section 6.1: wall area
    seed_size: int = Field(5, ge=2, le=25, description="side of a seed [px]; section 6.1")
    max_seeds: int = Field(1200, ge=100, le=20_000, description="seeds are thinned regularly to about this many; ours")
    max_sigma: float = Field(0.2, gt=0, le=1, description="largest standard deviation within a seed; section 6.1")
    depth_scale: float = Field(
        0.1, gt=0, le=10, description="depth [m] that counts as much as black against white; ours"
    )
    delta: float = Field(0.7, ge=-1, le=1, description="least silhouette of a seed that is kept; sections 6.1 and 8")
    max_clusters: int = Field(8, ge=2, le=20, description="most clusters that k-means tries; ours")
    min_silhouette: float = Field(
        0.5, ge=-1, le=1, description="mean silhouette below which a wall is one cluster; ours"
    )

    # Section 6.2: doors
    colour_threshold: Literal["capped", "otsu"] = Field(
        "capped", description="Otsu's threshold as in section 6.2, or that one kept between noise and a cap"
    )
    colour_edge_cap: float = Field(0.02, gt=0, le=1, description="gradient per pixel that is always an edge; ours")
    depth_edge: float = Field(0.010, gt=0, le=1, description="depth step that is always an edge [m]; ours, 3 sigma")
    alpha1: float = Field(0.5, ge=0, le=1, description="least share of the dominant colour and depth; section 6.2")
    alpha2: float = Field(0.6, ge=0, le=1, description="least support of each side by discontinuities; section 6.2")
    alpha3: float = Field(0.03, ge=0, le=1, description="largest share of wall area; section 6.2")
    min_width: float = Field(0.5, gt=0, le=5, description="narrowest leaf [m]; ours")
    max_width: float = Field(2.4, gt=0, le=10, description="widest doorway, of two leaves [m]; ours")
    min_height: float = Field(1.6, gt=0, le=5, description="lowest doorway [m]; ours")
    max_height: float = Field(2.6, gt=0, le=10, description="highest doorway [m]; ours")
    min_visible_closed: float = Field(
        0.42, ge=0, le=1, description="least visible share of a closed door; section 7.4 has 40 % of a panel occluded"
    )
    min_visible: float = Field(
        0.35, ge=0, le=1, description="least visible share of a doorway; ours: an open leaf hides more than 40 %"
    )
    max_protrusion: float = Field(
        0.06, ge=0, le=0.2, description="a closed leaf stands out no further than this [m]; ours"
    )

    faint_doors: bool = Field(
        True, description="also look for doors that nearly have the wall's colour, by edges just above the noise; ours"
    )
    settle_sides: bool = Field(
        True, description="False leaves the sides on the lines of section 6.2, whole pixels; True moves them, ours"
    )

    # Section 6.3: opening angle
    leaf_slice: Literal["all", "half-height"] = Field(
        "all", description="points for the angle: the whole leaf, or a slice at half height as in section 6.3"
    )
    closed_angle: float = Field(
        0.0175, ge=0, le=1.6, description="a leaf below this angle is closed [rad]; ours, 1 deg"
    )
    max_angle: float = Field(1.92, gt=0, le=3.15, description="widest opening [rad]; section 6.3: 110 deg")
    leaf_inlier: float = Field(
        0.012, gt=0, le=0.2, description="distance of an inlier from the leaf's line [m]; ours, 4 sigma"
    )
