"""Viewers that follow a mission while it runs; its files are written all the same."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from time import monotonic, sleep
from urllib.parse import urlsplit

import rerun as rr
import rerun_cli

from mission.errors import UsageError

HOST = "127.0.0.1"
"""Nobody but this machine can reach what is served here; Rerun's own default is everybody."""
VIEWER = Path(rerun_cli.__file__).with_name("rerun")
"""The program itself: the `rerun` on the path is a wrapper that outlives its end."""
PATIENCE = 30.0
"""For a viewer to start or to answer [s]."""
FRESH = 1.5
"""A viewer that cannot open a window listens first, and ends within this time [s]."""

Stream = rr.GrpcSink | rr.GrpcServerSink


def live_streams(*, view: bool = False, connect: str | None = None, serve: int | None = None) -> tuple[Stream, ...]:
    """Where to stream a recording to, besides its file.

    Args:
        view: Start a viewer on this machine's screen; it stays when the mission is over.
        connect: URL of a viewer that runs already, such as rerun+http://192.168.0.7:9876/proxy.
        serve: Port of this machine, and of it alone, where viewers find the mission for as long as it runs.

    Raises:
        UsageError: There is no viewer, or the port is taken.
    """
    streams: list[Stream] = []
    if view:
        streams.append(rr.GrpcSink(_started()))
    if connect is not None:
        streams.append(rr.GrpcSink(_reached(connect)))
    if serve is not None:
        _bind(serve)
        streams.append(rr.GrpcServerSink(bind_ip=HOST, port=serve))
    return tuple(streams)


def address(port: int) -> str:
    """URL of what this machine serves at a port."""
    return f"rerun+http://{HOST}:{port}/proxy"


def _started() -> str:
    """Start a viewer and return its URL."""
    if sys.platform == "linux" and not any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
        raise UsageError("--view: there is no screen; --serve and --connect need none")
    port = _bind(0)
    options = ["--bind", HOST, "--port", str(port), "--hide-welcome-screen"]
    viewer = subprocess.Popen([VIEWER, *options], stderr=subprocess.DEVNULL, start_new_session=True)
    end = monotonic() + PATIENCE
    while not _listens(HOST, port) and viewer.poll() is None and monotonic() < end:
        sleep(0.1)
    sleep(FRESH)
    if viewer.poll() is not None or not _listens(HOST, port):
        viewer.kill()
        raise UsageError("--view: the viewer does not start; --serve and --connect need no screen")
    viewer.returncode = 0  # it is on its own from now on
    return address(port)


def _reached(url: str) -> str:
    """A URL, if somebody listens there."""
    try:
        parts = urlsplit(url)
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if host is None or port is None or parts.scheme not in {"rerun", "rerun+http", "rerun+https"}:
        raise UsageError(f"--connect {url}: expected a URL such as {address(9876)}")
    if not _listens(host, port):
        raise UsageError(f"--connect {url}: no viewer listens there")
    return url


def _listens(host: str, port: int) -> bool:
    try:
        socket.create_connection((host, port), timeout=5.0).close()
    except OSError:
        return False
    return True


def _bind(port: int) -> int:
    """The port, or a free one for 0; Rerun itself would only note in passing that it cannot listen."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as servers do: the last one's port is free
        try:
            probe.bind((HOST, port))
        except (OSError, OverflowError) as error:
            raise UsageError(f"--serve: port {port} cannot be had: {error}") from error
        return int(probe.getsockname()[1])


_WRITTEN_WITHIN = 60.0
"""What takes longer to write never ends: Rerun would wait for a full disk [s]."""


def flush(rec: rr.RecordingStream, *, streams: Sequence[Stream]) -> bool:
    """Bring all that was recorded into the file and to the viewers.

    Returns:
        Whether every viewer is still there.
    """
    try:
        rec.flush(timeout_sec=_WRITTEN_WITHIN)
    except RuntimeError as error:
        if not streams or "gRPC" not in str(error):  # the file comes first: what it says goes before the viewers'
            raise
        return False
    return True
