"""Versions of what a result depends on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = (
    "door-mission",
    "foxglove-sdk",
    "mujoco",
    "numpy",
    "opencv-python-headless",
    "rerun-sdk",
    "scikit-image",
    "scikit-learn",
    "scipy",
)


def versions() -> dict[str, str]:
    """Version of Python and of each package; "not installed" for a checkout that runs in place."""
    return {"python": platform.python_version()} | {package: _version(package) for package in PACKAGES}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
