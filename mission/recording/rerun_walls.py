"""The detector's stages in the Rerun recording, wall by wall, in the order of the paper's figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import rerun as rr
from numpy.typing import NDArray

from detector.metrics import overlap
from detector.result import Candidate, Highlights, Orthoimage, Rectangle, WallResult
from mission.angles import share_text
from mission.events import DoorsDetected, Event
from mission.recording import entities
from mission.recording.drawing import jpeg
from mission.recording.legends import draw_legend, draw_legend_column
from mission.recording.rerun_world import hover

ACCEPTED = (70, 210, 90)
REJECTED = ((235, 70, 70), (240, 170, 50), (80, 160, 240), (200, 110, 220), (90, 210, 210), (230, 150, 170))
"""Of rectangles, by the condition that rejected them: the most frequent one first."""
LINE = (255, 120, 40)
SHOWN_CANDIDATES = 12
"""At most so many rejected rectangles are drawn: of a cluttered wall there are thousands."""
SAME = 0.85
"""Rejected rectangles with a larger intersection over union look the same."""
CENTROID = (220, 60, 60)
TRINARY = np.array([entities.NOTHING, entities.DATA, entities.CENTROID], np.uint8)
VISIBILITY = np.array([entities.NOTHING, entities.DATA, entities.SEEN_THROUGH, entities.BLOCKED], np.uint8)
SEED, NEUTRAL = (255, 255, 255), (190, 190, 190)
DEPTH_RANGE = 0.15
"""Depths from the wall plane beyond this share the colours at the ends of the scale [m]."""
DEPTHS = (("15 cm behind", (130, 130, 255)), ("on the wall", (164, 252, 60)), ("15 cm before", (220, 60, 30)))
"""Legend of the depths: colours of the scale, the darkest lightened to be read."""


class Walls:
    """Draws every intermediate product of the detector."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec

    def draw(self, event: Event) -> None:
        """Draw one event; only the detector's has walls."""
        if isinstance(event, DoorsDetected):
            for number, result in enumerate(event.results, start=1):
                draw_wall(self._rec, entities.stages(entities.wall_name(event.room, number)), result)


def draw_wall(rec: rr.RecordingStream, entity: str, result: WallResult) -> None:
    """Draw all stages of a wall below an entity."""
    for place, (view, highlights) in enumerate(zip(result.views, result.highlights, strict=True)):
        _draw_view(rec, f"{entity}/view/{place}", view, highlights)
    _draw_merged(rec, f"{entity}/merged", result)
    _draw_openings(rec, f"{entity}/openings", result)
    _draw_wall_area(rec, f"{entity}/wall_area", result)
    _draw_search(rec, entity, result)


def _draw_view(rec: rr.RecordingStream, entity: str, view: Orthoimage, highlights: Highlights) -> None:
    """Section 4.1, figures 3 and 4."""
    rec.log(f"{entity}/colour", _picture(view.colour))
    rec.log(f"{entity}/inpainted", _picture(highlights.inpainted))
    classes = np.zeros(highlights.regions.shape, np.uint8)
    classes[highlights.region_of_interest] = entities.REGION_OF_INTEREST
    classes[highlights.candidates > 0] = entities.BRIGHT
    classes[highlights.regions] = entities.HIGHLIGHT
    rec.log(f"{entity}/highlights/regions", rr.SegmentationImage(classes, opacity=0.5))
    kinds = (entities.REGION_OF_INTEREST, entities.BRIGHT, entities.HIGHLIGHT)
    draw_legend(rec, f"{entity}/highlights", classes.shape, [*map(entities.legend, kinds), ("outline", LINE)])
    ends = [contour[:, ::-1] + 0.5 for contour in highlights.contours]  # (row, column) to (x, y)
    rec.log(
        f"{entity}/highlights/profiles",
        rr.LineStrips2D([np.concatenate([end, end[:1]]) for end in ends], colors=LINE, radii=rr.Radius.ui_points(1.0)),
    )


def _draw_merged(rec: rr.RecordingStream, entity: str, result: WallResult) -> None:
    """Section 4.2: the unified orthoimage, its depth, and the doors that were found in it."""
    rec.log(f"{entity}/colour", _picture(result.merged.colour))
    millimetres = np.nan_to_num(result.merged.depth * 1000.0, nan=-32000.0)  # no data looks like a deep hole
    rec.log(
        f"{entity}/depth",
        rr.DepthImage(
            np.clip(millimetres, -32000, 32000).astype(np.int16),
            meter=1000.0,
            colormap="turbo",
            depth_range=(-DEPTH_RANGE * 1000, DEPTH_RANGE * 1000),
        ),
    )
    draw_legend(rec, f"{entity}/depth", result.merged.depth.shape, DEPTHS)
    doors = [door.rectangle for door in result.doors]
    labels = [f"{door.kind}, {door.state}, confidence {share_text(door.confidence)}" for door in result.doors]
    _draw_boxes(rec, f"{entity}/doors", result, doors, colours=[ACCEPTED] * len(doors), labels=labels)


def _draw_openings(rec: rr.RecordingStream, entity: str, result: WallResult) -> None:
    """Section 5, figure 7."""
    openings = result.openings
    rec.log(f"{entity}/trinary", rr.SegmentationImage(TRINARY[openings.trinary]))
    centroids = np.argwhere(openings.trinary == 2)[:, ::-1] + 0.5  # (row, column) to (x, y)
    rec.log(f"{entity}/centroids", rr.Points2D(centroids, colors=CENTROID, radii=rr.Radius.ui_points(2.0)))
    seen = [entities.legend(kind) for kind in (entities.DATA, entities.CENTROID)]
    named = [*seen, ("line", LINE), ("open door", ACCEPTED)]
    draw_legend(rec, f"{entity}/rectangles", openings.trinary.shape, named)
    kinds = (entities.DATA, entities.SEEN_THROUGH, entities.BLOCKED)
    draw_legend(rec, f"{entity}/visibility", openings.visibility.shape, [entities.legend(kind) for kind in kinds])
    rec.log(f"{entity}/visibility", rr.SegmentationImage(VISIBILITY[openings.visibility]))
    rec.log(f"{entity}/lines", _lines(openings.trinary.shape, openings.horizontal_lines, openings.vertical_lines))
    colours = [ACCEPTED if door else LINE for door in openings.is_door]
    labels = ["open door" if door else "not a door" for door in openings.is_door]
    _draw_boxes(rec, f"{entity}/rectangles", result, openings.rectangles, colours=colours, labels=labels)


def _draw_wall_area(rec: rr.RecordingStream, entity: str, result: WallResult) -> None:
    """Section 6.1, figure 8."""
    area = result.wall_area
    clusters = np.where(area.clusters > 0, area.clusters + entities.CLUSTERS, entities.NOTHING)
    rec.log(f"{entity}/clusters", rr.SegmentationImage(clusters.astype(np.min_scalar_type(clusters.max()))))
    kept = area.seeds[area.seed_clusters > 0]
    rec.log(
        f"{entity}/seeds",
        rr.Points2D(kept[:, ::-1] + 2.5, colors=SEED, radii=rr.Radius.ui_points(0.8)),  # middle of 5 x 5
    )
    draw_legend(rec, f"{entity}/seeds", area.mask.shape, [("seed", SEED), ("a colour a cluster", NEUTRAL)])
    draw_legend(rec, f"{entity}/mask", area.mask.shape, [entities.legend(entities.WALL_AREA)])
    mask = np.where(area.mask, entities.WALL_AREA, entities.NOTHING)
    rec.log(f"{entity}/mask", rr.SegmentationImage(mask.astype(np.uint8), opacity=0.6))


def _draw_search(rec: rr.RecordingStream, entity: str, result: WallResult) -> None:
    """Section 6.2, figures 9 and 10."""
    search = result.search
    in_colour, in_depth = _widened(search.colour_edges), _widened(search.depth_edges)
    classes = np.zeros(search.edges.shape, np.uint8)
    classes[in_colour] = entities.COLOUR_EDGE
    classes[in_depth] = entities.DEPTH_EDGE
    classes[in_colour & in_depth] = entities.BOTH_EDGES
    rec.log(f"{entity}/edges/classes", rr.SegmentationImage(classes))
    kinds = (entities.COLOUR_EDGE, entities.DEPTH_EDGE, entities.BOTH_EDGES)
    draw_legend(rec, f"{entity}/edges", classes.shape, [*map(entities.legend, kinds), ("line", LINE)])
    rec.log(f"{entity}/edges/lines", _lines(classes.shape, search.horizontal_lines, search.vertical_lines))
    _draw_candidates(rec, f"{entity}/candidates", result)


def _draw_candidates(rec: rr.RecordingStream, entity: str, result: WallResult) -> None:
    """Rectangles in the colour of the condition that rejected them, and beside the wall which colour is which."""
    shown = shown_candidates(result.search.candidates)
    verdicts = [candidate.rejected_by or "accepted" for candidate in shown]
    counts = Counter(verdicts)
    conditions = sorted(counts.keys() - {"accepted"}, key=lambda verdict: (-counts[verdict], verdict))
    colours = {"accepted": ACCEPTED} | {name: REJECTED[i % len(REJECTED)] for i, name in enumerate(conditions)}
    _draw_boxes(
        rec,
        entity,
        result,
        [candidate.rectangle for candidate in shown],
        colours=[colours[verdict] for verdict in verdicts],
        hovered=_conditions(shown),
    )
    told = [(f"{counts[verdict]} {verdict}", colour) for verdict, colour in colours.items() if counts[verdict]]
    draw_legend_column(rec, entity, result.search.edges.shape, told)


def _conditions(candidates: Sequence[Candidate]) -> list[rr.AnyValues]:
    """What section 6.2's conditions look at, for hovering."""
    columns = ("dominant_colour_share", "dominant_depth_share", "wall_share", "surroundings")
    shares: dict[str, Any] = {name: np.array([getattr(c, name) for c in candidates], float) for name in columns}
    shares["least_side_support"] = np.array([min(c.side_support) for c in candidates], float)
    shares["rejected_by"] = [candidate.rejected_by or "" for candidate in candidates]
    return hover(**shares)


def shown_candidates(candidates: Sequence[Candidate]) -> list[Candidate]:
    """The candidates to draw, the accepted ones last, so that they lie on top.

    Of the rejected ones those that came furthest, by how well their weakest side is supported, and that are not much
    the same as one that is shown already.
    """
    accepted = [candidate for candidate in candidates if candidate.rejected_by is None]
    rejected = [candidate for candidate in candidates if candidate.rejected_by is not None]
    rejected.sort(key=lambda candidate: min(candidate.side_support), reverse=True)
    shown: list[Candidate] = []
    for candidate in rejected:
        if len(shown) == SHOWN_CANDIDATES:
            break
        if all(overlap(candidate.rectangle, other.rectangle).iou < SAME for other in shown):
            shown.append(candidate)
    return [*shown, *accepted]


def _widened(edges: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Edges three pixels wide: thinner ones vanish when a viewer shrinks the image."""
    return cv2.dilate(edges.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0


def _picture(image: NDArray[np.uint8]) -> rr.EncodedImage:
    return rr.EncodedImage(contents=jpeg(image), media_type="image/jpeg")


def _draw_boxes(
    rec: rr.RecordingStream,
    entity: str,
    result: WallResult,
    rectangles: Sequence[Rectangle],
    *,
    colours: Sequence[tuple[int, int, int]],
    labels: Sequence[str] = (),
    hovered: Sequence[rr.AnyValues] = (),
) -> None:
    """Rectangles on the wall as boxes in its images, their labels, if any, one below the other."""
    pixel, height = result.merged.pixel_size, result.wall.height
    mins = [(r.left / pixel, (height - r.top) / pixel) for r in rectangles]
    sizes = [(r.width / pixel, r.height / pixel) for r in rectangles]
    thickness = rr.Radius.ui_points(1.5)
    rec.log(f"{entity}/boxes", rr.Boxes2D(mins=mins, sizes=sizes, colors=colours, radii=thickness), *hovered)
    places = [
        (left + width / 2, top + tall * (len(mins) - 1 - number) / len(mins))
        for number, ((left, top), (width, tall)) in enumerate(zip(mins, sizes, strict=True))
    ]
    if labels:
        rec.log(f"{entity}/labels", rr.Points2D(places, colors=colours, radii=0.0, labels=labels, show_labels=True))


def _lines(shape: tuple[int, ...], rows: NDArray[np.int32], columns: NDArray[np.int32]) -> rr.LineStrips2D:
    """Lines of a lateral histogram, from one end of the image to the other."""
    height, width = shape[:2]
    across = [[(0.0, row + 0.5), (width, row + 0.5)] for row in rows]
    down = [[(column + 0.5, 0.0), (column + 0.5, height)] for column in columns]
    return rr.LineStrips2D(across + down, colors=(*LINE, 130), radii=rr.Radius.ui_points(0.5))
