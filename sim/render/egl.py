"""Whether EGL gives an OpenGL context on this machine, found out without taking a side.

Once PyOpenGL has loaded libEGL for the whole process, MuJoCo takes OpenGL's functions from there, and OSMesa is no
longer possible. So EGL is tried through a private handle, before PyOpenGL has its say.
"""

from __future__ import annotations

import ctypes
from ctypes import POINTER, byref, c_char_p, c_int, c_uint, c_void_p
from typing import Any

_PLATFORM_DEVICE = 0x313F
_OPENGL_API = 0x30A2
_NONE = 0x3038
_ATTRIBUTES = (0x3033, 0x0001, 0x3040, 0x0008, 0x3025, 24, _NONE)
"""A pbuffer, OpenGL and 24 bits of depth, as MuJoCo asks for them."""
_MAX_DEVICES = 64


def egl_objection() -> str | None:
    """Why EGL gives no context; None if it does. Its displays stay open for whoever uses them next."""
    try:
        egl = _functions(ctypes.CDLL("libEGL.so.1"))
        displays = _displays(egl)
    except (OSError, AttributeError) as error:  # an EGL without devices lacks their functions
        return f"EGL cannot be used ({error})"
    if not displays:
        return "EGL finds no device: there is no driver"
    if not any(_gives_context(egl, display) for display in displays):
        return "EGL's driver makes no OpenGL context"
    return None


def _functions(library: ctypes.CDLL) -> Any:
    """The library with the signatures of what is called, its extensions among them."""
    library.eglGetProcAddress.restype, library.eglGetProcAddress.argtypes = c_void_p, [c_char_p]
    library.eglInitialize.argtypes = [c_void_p, c_void_p, c_void_p]
    library.eglChooseConfig.argtypes = [c_void_p, POINTER(c_int), POINTER(c_void_p), c_int, POINTER(c_int)]
    library.eglCreateContext.restype, library.eglCreateContext.argtypes = c_void_p, 4 * [c_void_p]
    library.eglDestroyContext.argtypes = [c_void_p, c_void_p]
    signatures = {
        "eglQueryDevicesEXT": ctypes.CFUNCTYPE(c_uint, c_int, POINTER(c_void_p), POINTER(c_int)),
        "eglGetPlatformDisplayEXT": ctypes.CFUNCTYPE(c_void_p, c_uint, c_void_p, c_void_p),
    }
    for name, signature in signatures.items():
        address = library.eglGetProcAddress(name.encode())
        if not address:
            raise AttributeError(f"no {name}")
        setattr(library, name, signature(address))
    return library


def _displays(egl: Any) -> list[int]:
    """Those of all devices that start."""
    devices, count = (c_void_p * _MAX_DEVICES)(), c_int(0)
    if not egl.eglQueryDevicesEXT(_MAX_DEVICES, devices, byref(count)):
        return []
    displays = [egl.eglGetPlatformDisplayEXT(_PLATFORM_DEVICE, device, None) for device in devices[: count.value]]
    return [display for display in displays if display and egl.eglInitialize(display, None, None)]


def _gives_context(egl: Any, display: int) -> bool:
    config, count = c_void_p(), c_int(0)
    attributes = (c_int * len(_ATTRIBUTES))(*_ATTRIBUTES)
    if not egl.eglChooseConfig(display, attributes, byref(config), 1, byref(count)) or not count.value:
        return False
    egl.eglBindAPI(_OPENGL_API)
    context = egl.eglCreateContext(display, config, None, None)
    return bool(context) and bool(egl.eglDestroyContext(display, context))
