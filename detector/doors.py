"""Doors as rectangles of discontinuities that are not wall (section 6.2)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from detector.candidates import (
    CORNER_SUPPORT,
    FOOT_SUPPORT,
    MAX_OVERSHOOT,
    OVERSHOOT,
    Boxes,
    Scene,
    corner_support,
    door_boxes,
    inner_shares,
    interrupts,
    overshoot,
    side_support,
    surroundings,
)
from detector.dominance import Dominance, dominance
from detector.edges import find_edges
from detector.frame import leaves_in_frames
from detector.occluders import occluders
from detector.openings import Visibility
from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.rectangles import find_lines
from detector.result import Candidate, DoorSearch, Image, Mask, Orthoimage, Rectangle, WallArea
from detector.selection import covers, frames, smallest
from detector.sill import hangs
from detector.steps import is_set_apart, steps

LINE_SHARE = 0.45
"""Share of the window that a line covers at least: of the shortest side of a door, with occlusion."""
FAIRLY_SET = 0.5
"""Least share of wall along each side's outside."""
OPEN_SHARE = 0.15
"""A rectangle that is looked through over more than this share is open."""
CLEAR_SUPPORT = 0.8
"""Support of every side of an outline that cuts a rectangle out of a wall of its own colour."""
CLEAR_FOOT = 0.6
"""Likewise of each foot: a skirting or a threshold takes a hand's breadth of it."""
MOSTLY_SEEN = 0.6
"""Share of a door of faint outline that shows at least: the shadows of a shelf are a faint outline round it, too."""
ENDS = 0.2
"""The head of a door of boards among boards is all there is to tell it from them: it must end, within this."""
MAX_LINES = 50
SHOWN = 30
"""Rejected candidates that are kept for the record."""
JUDGED = 160
"""Candidates that reach the costly conditions at most."""


def find_doors(
    merged: Orthoimage,
    seen: Image,
    face: Mask,
    area: WallArea,
    plan: tuple[float, float],
    parameters: DetectorParameters,
) -> tuple[DoorSearch, Scene]:
    """Candidate rectangles and the judgement on each.

    Args:
        seen: (H, W) `Visibility`.
        face: (H, W) where some view shows the wall's face.
        plan: Height of the wall, and of the floor along v [m].

    Returns:
        The search, and the images it was made on.
    """
    height, floor = plan
    px = merged.pixel_size
    edges = find_edges(merged, seen, parameters)
    floor_row = min(round((height - floor) / px), merged.depth.shape[0])
    lowest = max(1, floor_row - int(np.ceil(parameters.floor_margin / px)) - 1)
    hidden = occluders(merged, seen, edges, parameters)
    visible = ((seen == Visibility.DATA) | (seen == Visibility.THROUGH)) & ~hidden
    open_to_view = ((seen != Visibility.SHADOWED) & ~hidden)[:lowest]
    wall = area.mask & ~edges.sloping  # a leaf of the wall's colour is near its plane beside the hinge
    looked_at = Scene(merged, seen, edges, wall, face, visible, hidden, floor_row, lowest, parameters.max_protrusion)

    def search(upright: Mask, level: Mask, faint: bool) -> tuple[tuple[Candidate, ...], Scene, tuple[NDArray, NDArray]]:
        found = replace(
            edges,
            upright=upright & ~hidden,
            level=level & ~hidden,
            faint_level=edges.faint_level & ~hidden,
            level_ends=(edges.level_ends if faint else level) & ~hidden,
        )
        scene = replace(looked_at, edges=found)
        lines = (
            find_lines(
                found.upright[:lowest], 0, round(parameters.min_height / px), LINE_SHARE, MAX_LINES, open_to_view
            ),
            find_lines(found.level[:lowest], 1, round(parameters.min_width / px), LINE_SHARE, MAX_LINES, open_to_view),
        )
        boxes = door_boxes(*lines, scene, parameters)
        return judge(boxes, scene, height, floor, parameters, faint=faint), scene, lines

    searches = [(edges.upright, edges.level, False)]
    if parameters.faint_doors:
        searches.append((edges.faint_upright, edges.faint_level, True))
    (candidates, scene, (vertical, horizontal)), *fainter = each(lambda outline: search(*outline), searches)
    candidates, leaves = leaves_in_frames(candidates, merged, height)
    for more, _, _ in fainter:
        candidates += fainter_doors(tuple(c for c in more if not any(covers(c, leaf) for leaf in leaves)), candidates)
    candidates = smallest(candidates)
    result = DoorSearch(
        colour_edges=edges.colour,
        depth_edges=edges.depth,
        edges=edges.colour | edges.depth,
        horizontal_lines=np.rint(horizontal).astype(np.int32),
        vertical_lines=np.rint(vertical).astype(np.int32),
        candidates=candidates,
    )
    return result, scene


def fainter_doors(faint: tuple[Candidate, ...], clear: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
    """Those of faint outline that claim no piece of wall of one of clear outline, unless this is their frame."""
    doors = [c for c in smallest(clear) if c.rejected_by is None]
    kept = []
    for candidate in faint:
        round_it = [d for d in doors if covers(candidate, d)]
        if candidate.rejected_by is None and (not round_it or any(frames(d, candidate) for d in round_it)):
            kept.append(candidate)
    return tuple(kept)


def judge(
    boxes: Boxes, scene: Scene, height: float, floor: float, parameters: DetectorParameters, *, faint: bool = False
) -> tuple[Candidate, ...]:
    """The rectangles with the shares that the conditions look at, and the first condition that each fails.

    Args:
        faint: Whether the outline is of faint edges, too: then it must stand alone, and nobody asks what failed.
    """
    if len(boxes) == 0:
        return ()
    support, feet = side_support(boxes, scene)
    corners = corner_support(boxes, scene)
    wall, visible, through = inner_shares(boxes, scene)
    around = surroundings(boxes, scene)
    in_wall = wall > parameters.alpha3
    alone = _stand_alone(boxes, support, feet, in_wall, scene)
    if faint:
        alone &= visible > MOSTLY_SEEN
    least_visible = np.where(through < OPEN_SHARE, parameters.min_visible_closed, parameters.min_visible)
    reasons = np.full(len(boxes), None, object)
    checks = (
        ("door frame occlusion", support.min(axis=1) < parameters.alpha2),
        ("corners", corners.min(axis=1) < (CLEAR_SUPPORT if faint else CORNER_SUPPORT)),
        ("location consistency", (in_wall | faint) & ~alone),
        ("panel occlusion", visible < least_visible),
        ("floor", feet.min(axis=1) < FOOT_SUPPORT),
        ("surroundings", around.min(axis=1) < FAIRLY_SET),
    )
    for name, failed in checks:
        reasons[(reasons == None) & failed] = name  # noqa: E711 - elementwise
    survivors = np.flatnonzero(reasons == None)  # noqa: E711 - elementwise
    survivors = survivors[np.argsort(-support[survivors].sum(axis=1), kind="stable")][:JUDGED]
    rejected = np.flatnonzero(reasons != None)  # noqa: E711 - elementwise
    rejected = rejected[np.argsort(-support[rejected].sum(axis=1), kind="stable")][: 0 if faint else SHOWN]
    candidates = []
    for i in [*survivors, *rejected]:
        box = boxes[np.array([i])]
        shares = dominance(box, scene)
        left, above, right, below = (float(s) for s in support[i])
        reason = reasons[i] or _costly_reason(box, shares, scene, float(through[i]), parameters)
        candidates.append(
            Candidate(
                rectangle=_rectangle(box, scene.merged.pixel_size, height, floor),
                dominant_colour_share=shares.colour_share,
                dominant_depth_share=shares.depth_share,
                side_support=(left, above, right, below),
                wall_share=float(wall[i]),
                rejected_by=reason,
                surroundings=float(around[i].min()),
            )
        )
    return tuple(candidates)


def _stand_alone(
    boxes: Boxes, support: NDArray, feet: NDArray, in_wall: NDArray[np.bool_], scene: Scene
) -> NDArray[np.bool_]:
    """(N,) rectangles whose outline cuts them out of the wall, even if their colour is the wall's (ours).

    The wall area of section 6.1 takes in every door of nearly the wall's colour and depth. Such a door still has an
    unbroken outline that ends at its corners, and the same small step on all its sides.

    Args:
        in_wall: (N,) whether they hold wall area, so that their surface must be told from it.
    """
    closed = (support.min(axis=1) > CLEAR_SUPPORT) & (feet.min(axis=1) > CLEAR_FOOT)
    closed &= boxes.top * scene.merged.pixel_size > OVERSHOOT  # a plank goes up to the ceiling
    beyond = np.ones(len(boxes))
    beyond[closed] = overshoot(boxes[closed], scene)
    going_on = np.flatnonzero(closed & (beyond >= MAX_OVERSHOOT))
    closed[going_on] = interrupts(boxes[going_on], scene)
    for i in np.flatnonzero(closed)[np.argsort(-support[closed].sum(axis=1), kind="stable")][JUDGED:]:
        closed[i] = False
    for i in np.flatnonzero(closed & in_wall):
        closed[i] = is_set_apart(boxes[np.array([i])], scene, boards=bool(beyond[i] < ENDS))
    return closed


def _costly_reason(
    box: Boxes, shares: Dominance, scene: Scene, through: float, parameters: DetectorParameters
) -> str | None:
    """First failed condition of those that need the pixels themselves."""
    if min(shares.colour_share, shares.depth_share) < parameters.alpha1:
        return "colour and depth consistency"
    if through < OPEN_SHARE and not shares.depth < parameters.max_protrusion:
        return "protrusion"
    if not steps(box, scene).are_real():
        return "same on both sides"
    if hangs(box, scene):
        return "floor"
    return None


def _rectangle(box: Boxes, pixel_size: float, height: float, floor: float) -> Rectangle:
    """A box in wall coordinates; it stands on the floor."""
    left, right, top = (float(x[0] + 0.5) * pixel_size for x in (box.left, box.right, box.top))
    return Rectangle(left, floor, right, height - top)


def doorway_rectangles(search: DoorSearch) -> tuple[Rectangle, ...]:
    """Rectangles of the accepted candidates, from left to right."""
    return tuple(c.rectangle for c in search.candidates if c.rejected_by is None)
