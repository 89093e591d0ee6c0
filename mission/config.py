"""The configuration of a mission: the parameter models of all stages put together."""

from __future__ import annotations

import copy
import difflib
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from detector.parameters import DetectorParameters
from mission.candidates import PlanningParameters
from mission.errors import UsageError
from mission.linking import LinkParameters
from mission.navigation import NavigationParameters
from mission.registration import RegistrationParameters
from mission.samples import SampleParameters
from mission.structure import StructureParameters
from mission.voxels import VoxelParameters
from sim.guardian import RobotParameters
from sim.laser_scan import HokuyoParameters
from sim.parameters import Parameters
from sim.photo import CameraParameters
from sim.scan import ScannerParameters


class MissionConfig(Parameters):
    """Every parameter of a mission, stage by stage."""

    scanner: ScannerParameters = Field(default_factory=ScannerParameters, description="Riegl VZ-400")
    camera: CameraParameters = Field(default_factory=CameraParameters, description="Nikon D90 with flash")
    hokuyo: HokuyoParameters = Field(default_factory=HokuyoParameters, description="Hokuyo URG-04LX-UG01")
    robot: RobotParameters = Field(default_factory=RobotParameters, description="Robotnik Guardian")
    samples: SampleParameters = Field(default_factory=SampleParameters)
    registration: RegistrationParameters = Field(default_factory=RegistrationParameters)
    links: LinkParameters = Field(default_factory=LinkParameters, description="between rooms")
    structure: StructureParameters = Field(default_factory=StructureParameters)
    voxels: VoxelParameters = Field(default_factory=VoxelParameters)
    planning: PlanningParameters = Field(default_factory=PlanningParameters)
    navigation: NavigationParameters = Field(default_factory=NavigationParameters)
    detector: DetectorParameters = Field(default_factory=DetectorParameters)


def read_config(path: Path | None, settings: Iterable[str] = ()) -> MissionConfig:
    """Put a configuration together: defaults, then a TOML file, then `key=value` settings.

    Args:
        path: TOML file with a table a stage, or None.
        settings: Such as "detector.alpha1=0.4"; values are TOML, bare words are strings.

    Raises:
        UsageError: A file, key or value that cannot be used.
    """
    return changed_config(_read_toml(path) if path else {}, settings)


def changed_config(content: Mapping[str, Any], settings: Iterable[str]) -> MissionConfig:
    """Change a configuration by `key=value` settings.

    Args:
        content: A table a stage, as in summary.json under `config`; what is left out is as by default.
        settings: As for `read_config`.

    Raises:
        UsageError: A file, key or value that cannot be used.
    """
    changed: dict[str, Any] = copy.deepcopy(dict(content))
    for setting in settings:
        key, value = _parse(setting)
        table = changed
        for part in key[:-1]:
            table = table.setdefault(part, {})
            if not isinstance(table, dict):
                raise UsageError(f"--set {setting}: {part!r} is a value, not a table")
        table[key[-1]] = value
    try:
        return MissionConfig.model_validate(changed)
    except ValidationError as error:
        raise UsageError(f"configuration: {_first(error)}") from error


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text())
    except OSError as error:
        raise UsageError(f"{error.strerror}: {path}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"not TOML ({error}): {path}") from error


def _parse(setting: str) -> tuple[list[str], Any]:
    key, equals, text = setting.partition("=")
    if not equals or not all(key.split(".")):
        raise UsageError(f"--set {setting}: expected key=value, such as detector.alpha1=0.4")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text  # a bare word: scanner.pattern=draft
    return key.strip().split("."), value


def _first(error: ValidationError) -> str:
    """Say the first thing that is wrong in one line, and what would be right."""
    detail = error.errors()[0]
    key = ".".join(str(part) for part in detail["loc"])
    if detail["type"] != "extra_forbidden":
        return f"{key} = {detail['input']!r}: {detail['msg'][0].lower()}{detail['msg'][1:]}"
    known = _known_keys(detail["loc"][:-1])
    close = difflib.get_close_matches(str(detail["loc"][-1]), known, n=1)
    hint = f"did you mean {close[0]!r}?" if close else f"known keys: {', '.join(known)}"
    return f"unknown key {key!r}; {hint}"


def _known_keys(table: tuple[int | str, ...]) -> list[str]:
    model: Any = MissionConfig
    for part in table:
        model = model.model_fields[part].annotation
    return list(model.model_fields)
