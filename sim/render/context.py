"""An offscreen OpenGL context on any machine: EGL first, OSMesa second, no display needed."""

from __future__ import annotations

import ctypes
import importlib
import os
import sys
from typing import Any

from sim.errors import SimError
from sim.render.egl import egl_objection

_LIBRARIES = {
    "egl": (("libEGL.so.1",), ("libOpenGL.so.0", "libGL.so.1")),
    "osmesa": (("libOSMesa.so.8", "libOSMesa.so"),),
}
"""Shared libraries of each back end: one of every group must load."""

_HELP = "install software OpenGL with `apt-get install libegl1 libgl1` (or `apt-get install libosmesa6`)"


def make_context() -> Any:
    """Make an offscreen OpenGL context, and make it current.

    MuJoCo fixes its own choice when it is imported and falls back on a window; taking the back end's class directly
    works whoever imported mujoco first, and with no environment variable set. MUJOCO_GL=osmesa asks for OSMesa.

    Returns:
        One of MuJoCo's `GLContext` objects: `make_current()`, `free()`.

    Raises:
        SimError: there is no OpenGL on this machine; the message names the packages that bring it.
    """
    backend = _backend()
    try:
        context = importlib.import_module(backend).GLContext(64, 64)
        context.make_current()
    except Exception as error:  # PyOpenGL raises anything from ImportError to AttributeError for a missing library
        raise SimError(f"cannot start OpenGL with {backend} ({error}); {_HELP}".replace("\n", " ")) from error
    return context


def _backend() -> str:
    """Module of the first back end that has its libraries and, for EGL, a driver."""
    if sys.platform != "linux":
        return "mujoco.gl_context"
    names = ["osmesa", "egl"] if os.environ.get("MUJOCO_GL", "").lower() == "osmesa" else ["egl", "osmesa"]
    objections = []
    for name in names:
        objection = _missing(name) or (egl_objection() if name == "egl" else None)
        if objection is None:
            return f"mujoco.{name}"
        objections.append(objection)
    raise SimError(f"no OpenGL found ({'; '.join(objections)}); {_HELP}")


def _missing(name: str) -> str | None:
    """Which libraries a back end lacks; None if it has them."""
    missing = [" or ".join(group) for group in _LIBRARIES[name] if not any(_loads(library) for library in group)]
    return f"{' and '.join(missing)} cannot be loaded" if missing else None


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
