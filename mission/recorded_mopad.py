"""MoPAD as a recording has it: it measures again what it measured then, where it was then."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from mission.errors import MissionError
from mission.events import Photographed, Registered, Scanned
from mission.rigid import Pose, inverted
from sim.photo import Photo
from sim.scan import Scan


class RecordedMopad:
    """What the stages up to a registered scan need of `mission.mopad.Mopad`, without a simulator."""

    def __init__(self, base_from_scanner: Pose) -> None:
        """Before its first scan.

        Args:
            base_from_scanner: (4, 4) mount of the scanner.
        """
        self.robot = SimpleNamespace(base_from_scanner=base_from_scanner)
        self.time = 0
        """Mission time [ns]."""
        self.news: list[str] = []
        """What was put in the robot's way, in words."""
        self._scanned: Scanned | None = None
        self._photographed: Photographed | None = None
        self._registered: Registered | None = None

    def stand(self, scanned: Scanned, photographed: Photographed | None, registered: Registered) -> None:
        """Stand where a scan was taken."""
        self._scanned, self._photographed, self._registered = scanned, photographed, registered

    def scan(self) -> Scan:
        """The panorama of then."""
        assert self._scanned is not None
        self.time = self._scanned.time
        return self._scanned.scan

    def photograph(self) -> tuple[Photo, ...]:
        """The photographs of then."""
        if self._photographed is None:
            raise MissionError("no photographs were taken there")
        self.time = self._photographed.time
        return self._photographed.photos

    @property
    def world_from_base(self) -> Pose:
        """Where the robot believed to be before the scan was registered."""
        return self.world_from_scanner @ inverted(self.robot.base_from_scanner)

    @property
    def world_from_scanner(self) -> Pose:
        """Where the robot believed its scanner to be before the scan was registered."""
        assert self._registered is not None
        return self._registered.guess_world_from_scanner

    @property
    def true_world_from_scanner(self) -> Pose:
        """Where the scanner was."""
        assert self._scanned is not None
        return self._scanned.true_world_from_scanner

    def believe(self, world_from_base: Pose) -> None:
        """The next guess is recorded, too."""

    def measure_lasers(self) -> list[Any]:
        """None: they serve to find ways, and nobody drives."""
        return []
