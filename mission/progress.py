"""Progress on the terminal: a bar that names the stage, a line an event, a table of doors at the end."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from mission.angles import degrees_text, opening_text, share_text
from mission.evaluation import DoorEvaluation
from mission.events import (
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionFinished,
    MissionStarted,
    Planned,
    Registered,
    Remarked,
    RoomEntered,
    RoomsTied,
)
from mission.recording.sentences import sentence


class TerminalProgress:
    """A sink that tells a person what goes on."""

    def __init__(self, console: Console) -> None:
        """Write to a console: standard error, so that results can be piped."""
        self._console = console
        self._progress = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(bar_width=24),
            TextColumn("{task.completed:3.0f} % of the walls seen"),
            TimeElapsedColumn(),
            console=console,
            transient=True,
        )
        self._task = self._progress.add_task("loading", total=100)

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def stage(self, name: str) -> None:
        """Show what the program is busy with."""
        self._progress.update(self._task, description=f"{name:<14}")

    def handle(self, event: Event) -> None:
        """Take one event."""
        match event:
            case MissionStarted():
                x, y = event.world_from_base[:2, 3]
                self._console.print("[dim]mission time[/dim]")
                self._say(event, f"[bold]{event.scene}[/bold], seed {event.seed}: MoPAD starts at ({x:.2f}, {y:.2f})")
            case RoomEntered() if event.how != "start":
                self._say(event, f"[bold]{sentence(event)}[/bold]")
            case RoomsTied():
                self._say(event, sentence(event))
            case Registered():
                x, y = event.world_from_scanner[:2, 3]
                fit = event.reason if event.rmse == 0 or not event.accepted else f"residual {event.rmse * 1e3:.1f} mm"
                self._say(event, f"scan {event.scan_number} at ({x:.2f}, {y:.2f}): {fit}")
            case Labelled():
                self._progress.update(self._task, completed=100 * event.voxels.coverage)
            case Planned():
                self._planned(event)
            case Drove() if not event.arrived:
                self._say(event, f"[yellow]stopped on the way: {event.reason}[/yellow]")
            case Remarked():
                self._say(event, f"[yellow]{event.text}[/yellow]" if event.level == "warning" else event.text)
            case DoorsEvaluated():
                self._console.print(doors_table(event))
            case MissionFinished():
                self._say(event, f"{event.outcome}: {event.reason}")

    def _planned(self, event: Planned) -> None:
        plan = event.plan
        if plan.chosen is None:
            self._say(
                event,
                f"room {event.room} complete: {plan.stop_reason}, {plan.coverage:.0%} of walls, floor and ceiling seen",
            )
            return
        chosen = plan.candidates[plan.chosen]
        x, y = chosen.position
        self._say(
            event,
            f"next scan at ({x:.2f}, {y:.2f}), {chosen.travel:.1f} m away, "
            f"of {len(plan.candidates)} candidates; {plan.coverage:.0%} of walls, floor and ceiling seen",
        )

    def _say(self, event: Event, text: str) -> None:
        self._console.print(f"[dim]{event.time / 1e9:10.0f} s[/dim]  {text}", highlight=False, soft_wrap=True)


def doors_table(event: DoorsEvaluated) -> Table:
    """Each door beside its joint, and the doors that were missed."""
    count = len(event.doors)
    title = f"Room {event.room}: {count} door{'s' * (count != 1)}"
    table = Table(
        title=title, title_justify="left", box=SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0)
    )
    for column in ("door", "state", "size [m]", "angle", "joint", "error", "prec.", "recall", "sure"):
        right = column not in {"door", "state"}
        table.add_column(column, justify="right" if right else "left", no_wrap=True)
    table.add_column("true door", overflow="fold")
    for door in event.doors:
        table.add_row(*_row(door))
    for name in event.missed:
        table.add_row(*["[red]missed[/red]", *["-"] * 8, name])
    return table


def _row(evaluation: DoorEvaluation) -> list[str]:
    door, areas = evaluation.door, evaluation.overlap
    return [
        evaluation.door_id,
        door.state if door.kind == "single" else f"{door.state}, {door.kind}",
        f"{door.rectangle.width:.3f}x{door.rectangle.height:.3f}",
        opening_text(door.opening_angle, door.opened_fraction, unit="°"),
        opening_text(evaluation.true_angle, evaluation.true_opened_fraction, unit="°"),
        degrees_text(evaluation.angle_error, unit="°"),
        f"{areas.precision:.3f}" if areas else "-",
        f"{areas.recall:.3f}" if areas else "-",
        share_text(door.confidence),
        evaluation.true_name or "[red]false positive[/red]",
    ]
