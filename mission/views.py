"""The views of a room while it is scanned: kept as ranges, made into points when the detector reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self, overload

import numpy as np
from numpy.typing import NDArray

from detector.room import View
from mission.colouring import end_points
from mission.memory import release_freed_memory
from mission.rigid import Pose

if TYPE_CHECKING:
    from sim.scan import Scan


@dataclass(frozen=True, eq=False)
class ColouredScan:
    """A registered scan with its points' colours: a view of the detector in 8 bytes a beam, half of the view's own."""

    elevations: NDArray[np.float64]
    """(E,) [rad]."""
    azimuths: NDArray[np.float64]
    """(A,) [rad]."""
    ranges: NDArray[np.float32]
    """(E, A) [m]; NaN = no return."""
    world_from_scanner: Pose
    """As registered."""
    camera_in_world: NDArray[np.float64]
    """(3,) [m]."""
    colours: NDArray[np.uint8]
    """(N, 3) sRGB of the returns, row by row."""
    coloured: NDArray[np.bool_]
    """(N,) where a photograph saw the point."""

    @classmethod
    def of(cls, scan: Scan, view: View, world_from_scanner: Pose) -> Self:
        """What to keep of a scan and of the view that it was coloured to."""
        return cls(
            elevations=scan.elevations,
            azimuths=scan.azimuths,
            ranges=scan.ranges,
            world_from_scanner=world_from_scanner,
            camera_in_world=view.camera_in_world,
            colours=view.colours,
            coloured=view.coloured,
        )

    def view(self) -> View:
        """As the detector takes it: the very points that the scan was coloured with."""
        return View(
            points_in_world=end_points(self, self.world_from_scanner),
            colours=self.colours,
            coloured=self.coloured,
            scanner_in_world=self.world_from_scanner[:3, 3].copy(),
            camera_in_world=self.camera_in_world,
        )


class Views(Sequence[View]):
    """Views that are made when they are read: who reads one after another has one in memory."""

    def __init__(self, scans: Sequence[ColouredScan], *, once: bool = False) -> None:
        """Views of some scans.

        Args:
            scans: One a view.
            once: Whether a scan is let go when its view is read, which then cannot be read again.
        """
        self._scans: list[ColouredScan | None] = list(scans)
        self._once = once

    def __len__(self) -> int:
        return len(self._scans)

    @overload
    def __getitem__(self, number: int) -> View: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[View]: ...
    def __getitem__(self, number: int | slice) -> View | Sequence[View]:
        if isinstance(number, slice):
            return tuple(self[k] for k in range(*number.indices(len(self))))
        scan = self._scans[number]
        if scan is None:
            raise LookupError(f"view {number} was read before")
        if self._once:
            self._scans[number] = None
        release_freed_memory()  # of the view before
        return scan.view()
