"""The coloured cloud of the Rerun recording, as it grows scan by scan."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatchmethod
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.events import Coloured, Event, RoomEntered, RoomsTied, Scanned, Structured
from mission.recording import entities
from mission.recording.drawing import cell_keys, display_colours, on_grid, thin
from mission.recording.entities import child
from mission.recording.rerun_places import Places

if TYPE_CHECKING:
    from detector.room import View
    from sim.scanner import Scan

CELL = 0.05
"""Of the grid that has a point a cell [m]."""


@dataclass
class _Cloud:
    """What a scan adds for display."""

    scan_number: int
    points: NDArray[np.float32]
    colours: NDArray[np.uint8]
    reflectance: NDArray[np.int8] | None
    """(N,) to the decibel."""

    def part(self, which: NDArray[np.bool_]) -> list[rr.AsComponents]:
        """Some of it, as Rerun has it."""
        drawn = rr.Points3D(self.points[which], colors=self.colours[which], radii=rr.Radius.ui_points(1.5))
        if self.reflectance is None or not which.any():
            return [drawn]
        return [drawn, rr.AnyValues(reflectance_db=self.reflectance[which])]


class Clouds:
    """Draws of each scan what earlier ones of the room have not shown: more scans make no more points of a place."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._places = Places(rec)
        self._ceilings: dict[int, float] = {}
        self._waiting: _Cloud | None = None
        self._scan: Scan | None = None
        self._shown, self._shown_coloured = np.zeros(0, np.int64), np.zeros(0, np.int64)

    @singledispatchmethod
    def draw(self, event: Event) -> None:
        """Draw one event; most bring no points."""

    @draw.register
    def _(self, event: RoomEntered) -> None:
        self._places.follow(event)
        self._shown, self._shown_coloured = np.zeros(0, np.int64), np.zeros(0, np.int64)

    @draw.register
    def _(self, event: RoomsTied) -> None:
        self._places.follow(event)

    @draw.register
    def _(self, event: Scanned) -> None:
        self._scan = event.scan

    @draw.register
    def _(self, event: Coloured) -> None:
        view = event.view
        chosen = self._new(view, thin(view.points_in_world, cell=CELL))
        self._waiting = _Cloud(
            scan_number=event.scan_number,
            points=on_grid(view.points_in_world[chosen]),
            colours=display_colours(view.colours[chosen], view.coloured[chosen]),
            reflectance=_reflectance(self._scan, len(view.points_in_world), chosen),
        )
        self._scan = None
        self._draw(event.room)

    @draw.register
    def _(self, event: Structured) -> None:
        if event.structure.ceiling_height is not None:
            self._ceilings.setdefault(event.room, event.structure.ceiling_height)
        if self._waiting:  # the first scan of a room is drawn again, for now the ceiling is known
            self._draw(event.room)
            self._waiting = None

    def _new(self, view: View, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
        """Those of the chosen points whose cells show nothing yet, or nothing coloured and the point is."""
        keys, coloured = cell_keys(view.points_in_world[chosen], CELL), view.coloured[chosen]
        shown = np.isin(keys, self._shown, assume_unique=True)  # `thin` chose one point a cell
        shown_coloured = np.isin(keys, self._shown_coloured, assume_unique=True)
        self._shown = np.concatenate([self._shown, keys[~shown]])
        self._shown_coloured = np.concatenate([self._shown_coloured, keys[coloured & ~shown_coloured]])
        return chosen[~np.where(coloured, shown_coloured, shown)]

    def _draw(self, room: int) -> None:
        assert self._waiting is not None
        cloud, ceiling = self._waiting, self._ceilings.get(room)
        number = f"{cloud.scan_number:03d}"
        below = np.ones(len(cloud.points), bool) if ceiling is None else cloud.points[:, 2] < ceiling - 0.1
        self._rec.log(child(entities.CLOUDS, number, "points"), *cloud.part(below))
        if ceiling is not None:
            self._places.belongs(child(entities.CEILINGS, number), room)
            self._rec.log(child(entities.CEILINGS, number), *cloud.part(~below))
            self._waiting = None


def _reflectance(scan: Scan | None, count: int, chosen: NDArray[np.int64]) -> NDArray[np.int8] | None:
    """(M,) of the chosen ones of a view's points [dB]; None for a view that is not of all returns of the scan."""
    if scan is None or len(returned := np.flatnonzero(np.isfinite(scan.ranges))) != count:
        return None
    return np.clip(np.rint(scan.reflectance.ravel()[returned[chosen]]), -128, 127).astype(np.int8)
