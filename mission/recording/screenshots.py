"""Pictures of a recording's tabs, without a screen: `python -m mission.recording.screenshots runs/room-1/mission.rrd`.

Needs a Vulkan driver; on a machine without a GPU `apt-get install mesa-vulkan-drivers` brings one.
"""

from __future__ import annotations

import argparse
import io
import re
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Any, TypeVar

import numpy as np
import rerun_cli
from numpy.typing import NDArray
from PIL import Image
from rerun.experimental import ViewerClient

from mission.errors import MissionError

T = TypeVar("T")

COLOURS = 256
"""Of a picture: as a palette it takes a third of the space, and looks the same."""
BAR = 36
"""Height of the viewer's own bar at the top, which says nothing about the mission [px]."""


class ScreenshotError(MissionError):
    """There is no picture to be had."""


class NoViewer(ScreenshotError):
    """The viewer does not start: there is no Vulkan driver."""


def main(arguments: list[str] | None = None) -> int:
    """Take the pictures; exit status 1 if a view reports an error, 2 if there is no picture."""
    options = parser().parse_args(arguments)
    try:
        reports = screenshots(options.recording, options.out, only=options.tab, step=options.step, size=options.size)
    except (ScreenshotError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for report in reports:
        print(f"error: {report}", file=sys.stderr)
    return 1 if reports else 0


def parser() -> argparse.ArgumentParser:
    """The options."""
    options = argparse.ArgumentParser(
        prog="python -m mission.recording.screenshots",
        description="Draw every tab of a recording into a PNG, without a screen or a GPU.",
        allow_abbrev=False,
    )
    options.add_argument("recording", type=Path, metavar="MISSION.rrd")
    options.add_argument("--out", type=Path, metavar="DIR", help="folder for the pictures (default: the recording's)")
    options.add_argument("--tab", action="append", metavar="NAME", help="only this tab; may be repeated")
    options.add_argument("--step", type=int, metavar="N", help="of the mission's events (default: the last)")
    options.add_argument("--size", default="1600x900", metavar="WxH", help="of the window (default: 1600x900)")
    return options


def screenshots(
    recording: Path, out: Path | None, *, only: list[str] | None = None, step: int | None = None, size: str = "1600x900"
) -> list[str]:
    """Draw tabs into `<tab>.png`, in small letters and with `-` for a space.

    Args:
        recording: An .rrd file.
        out: Folder; None for the recording's.
        only: Names of tabs; None for all that are not folded away.
        step: On the timeline `step`; None for its end.
        size: Width and height of the window.

    Returns:
        What views say is wrong with what they are to show.

    Raises:
        ScreenshotError: The viewer does not start, shows nothing, or has no such tab.
    """
    if not recording.is_file():
        raise ScreenshotError(f"no such recording: {recording}")
    out = out or recording.parent
    out.mkdir(parents=True, exist_ok=True)
    reports = []
    with _viewer(size) as viewer:
        _open(viewer, recording, step)
        layout = viewer.get_blueprint(of="recording").blueprint
        tabs = _tabs(layout)
        for name in only or tabs:
            if name not in tabs:
                raise ScreenshotError(f"no tab {name!r}; there are: {', '.join(tabs)}")
            _root(layout)["active_tab"] = tabs[name]
            viewer.set_blueprint(layout, of="recording")
            path = out / f"{re.sub(r'[^a-z0-9.]+', '-', name.lower()).strip('.-')}.png"
            _save(_settled(viewer), path)
            print(path)
            views = viewer.get_state().views
            reports += [f"{name}, view {view.name}: {report.summary}" for view in views for report in view.reports]
    return reports


@contextmanager
def _viewer(size: str) -> Iterator[ViewerClient]:
    """A viewer that this process alone can reach."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    program = Path(rerun_cli.__file__).with_name("rerun")  # the `rerun` on the path is a wrapper that outlives its end
    options = ["--headless", "--bind", "127.0.0.1", "--port", str(port), "--hide-welcome-screen", "--window-size", size]
    process = subprocess.Popen([program, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def connected() -> ViewerClient | None:
        if process.poll() is not None:
            raise NoViewer("the viewer does not start: is a Vulkan driver there (apt: mesa-vulkan-drivers)?")
        try:
            viewer = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
            viewer.get_state()
        except Exception:  # of many kinds, until it listens
            return None
        return viewer

    try:
        yield _wait(connected, "the viewer to start")
    finally:
        process.terminate()
        process.wait(10)


def _open(viewer: ViewerClient, recording: Path, step: int | None) -> None:
    """Load a recording to its end and put the viewer at a step."""
    viewer.open(str(recording.resolve()))
    _wait(lambda: viewer.get_state().recordings or None, f"the viewer to open {recording}")
    _wait(lambda: None if viewer.get_state().loading else True, f"the viewer to read {recording}")
    timelines = {line.name: line for shown in viewer.get_state().recordings for line in shown.timelines}
    if "step" not in timelines:
        raise ScreenshotError(f"not the recording of a mission, which has a timeline `step`: {recording}")
    last = timelines["step"].end or 0
    viewer.set_time("step", sequence=last if step is None else step, play_state="paused")


def _root(layout: dict[str, Any]) -> dict[str, Any]:
    """The outermost container."""
    name = layout["/viewport"]["ViewportBlueprint"]["root_container"]
    return layout[f"/container/{name}"]["ContainerBlueprint"]


def _tabs(layout: dict[str, Any]) -> dict[str, str]:
    """The outermost tabs by their names, from left to right, without those that are folded away."""
    boxes = {path: layout[f"/{path}"]["ContainerBlueprint"] for path in _root(layout)["contents"]}
    return {box["display_name"]: path for path, box in boxes.items() if box.get("visible", True)}


def _settled(viewer: ViewerClient) -> NDArray[np.uint8]:
    """The window (H, W, 3), once two pictures of it are the same: the first ones lack what is still being loaded."""
    before = None

    def steady() -> NDArray[np.uint8] | None:
        nonlocal before
        picture = np.asarray(Image.open(io.BytesIO(viewer.take_screenshot())).convert("RGB"))[BAR:]
        compared = picture[:, : picture.shape[1] * 3 // 4]  # notes fade in and out in the last quarter
        last, before = before, compared
        return picture if last is not None and np.array_equal(last, compared) else None

    return _wait(steady, "the picture to settle")


def _wait(attempt: Callable[[], T | None], what: str, *, seconds: float = 180.0) -> T:
    """Try until there is an answer."""
    end = monotonic() + seconds
    while (answer := attempt()) is None:
        if monotonic() > end:
            raise ScreenshotError(f"waited {seconds:.0f} s for {what}")
        sleep(0.3)
    return answer


def _save(picture: NDArray[np.uint8], path: Path) -> None:
    """As a PNG of few colours: the few pixels of a rare colour need k-means, or they get a common one."""
    Image.fromarray(picture).quantize(COLOURS, kmeans=4, dither=Image.Dither.NONE).save(path, optimize=True)


if __name__ == "__main__":
    sys.exit(main())
