"""Configurations: defaults, files, settings, and what is said when one is wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from mission.config import MissionConfig, read_config
from mission.errors import UsageError

SCHEMA = MissionConfig.model_json_schema()


def numbers(model: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, list[Mapping[str, Any]]]]:
    """Key and JSON schemas of every numeric parameter below a model; several numbers where it is a list."""
    for name, field in model["properties"].items():
        if "$ref" in field:
            yield from numbers(SCHEMA["$defs"][field["$ref"].split("/")[-1]], f"{path}{name}.")
        elif field["type"] in ("number", "integer"):
            yield path + name, [field]
        elif field["type"] == "array":
            yield path + name, field.get("prefixItems") or [field["items"]]


NUMBERS = dict(numbers(SCHEMA))
FLOATS = {key: schemas for key, schemas in NUMBERS.items() if schemas[0]["type"] == "number"}


def test_without_file_and_settings_the_configuration_is_the_default() -> None:
    assert read_config(None) == MissionConfig()


def test_a_setting_wins_over_the_file(tmp_path: Path) -> None:
    file = tmp_path / "mission.toml"
    file.write_text("[detector]\nalpha1 = 0.3\nalpha2 = 0.7\n")
    config = read_config(file, ["detector.alpha1=0.4"])
    assert (config.detector.alpha1, config.detector.alpha2) == (0.4, 0.7)


def test_a_bare_word_is_a_string() -> None:
    assert read_config(None, ["scanner.pattern=draft"]).scanner.pattern == "draft"


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("detector.alfa1=0.4", "unknown key 'detector.alfa1'; did you mean 'alpha1'?"),
        ("nonsense.x=1", "unknown key 'nonsense'; known keys: scanner, camera"),
        ("detector.alpha1=2", "detector.alpha1 = 2: input should be less than or equal to 1"),
        ("scanner.pattern=fast", "scanner.pattern = 'fast'"),
        ("detector.alpha1", "expected key=value"),
        ("scanner.noise.x=1", "scanner.noise"),
        ("scanner=1", "scanner = 1"),
        ("scanner.max_range=0.5", "scanner.max_range = 0.5: input should be greater than or equal to 10"),
        ("robot.wheel_radius=inf", "robot.wheel_radius = inf: input should be a finite number"),
        ("registration.reaches=[0.5, -1]", "registration.reaches.1 = -1: input should be greater than 0"),
    ],
)
def test_a_wrong_setting_is_named_in_one_line(setting: str, said: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_config(None, [setting])
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("key", NUMBERS)
def test_every_number_has_a_least_and_a_greatest_value(key: str) -> None:
    for schema in NUMBERS[key]:
        assert {"minimum", "exclusiveMinimum"} & set(schema) and {"maximum", "exclusiveMaximum"} & set(schema)


@pytest.mark.parametrize("value", ["inf", "-inf", "nan"])
@pytest.mark.parametrize("key", FLOATS)
def test_a_number_that_is_not_finite_is_refused_everywhere(key: str, value: str) -> None:
    count = len(FLOATS[key])
    listed = f"[{', '.join([value] * count)}]" if key.endswith(("reaches", "recess")) else value
    with pytest.raises(UsageError, match=f"{key}.* = {value}: input should be a finite number"):
        read_config(None, [f"{key}={listed}"])


def test_a_setting_below_a_value_is_refused() -> None:
    with pytest.raises(UsageError, match="'noise' is a value, not a table"):
        read_config(None, ["scanner.noise=true", "scanner.noise.x=1"])


def test_a_file_that_is_not_toml_is_named(tmp_path: Path) -> None:
    file = tmp_path / "broken.toml"
    file.write_text("[detector\n")
    with pytest.raises(UsageError, match=r"not TOML .*broken\.toml"):
        read_config(file)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"No such file or directory: .*absent\.toml"):
        read_config(tmp_path / "absent.toml")


def test_every_angle_is_in_radians_and_every_limit_has_the_same_prefix() -> None:
    odd = ("_deg", "maximum_", "minimum_", "least_", "largest_", "smallest_", "longest_", "lowest_", "_min", "_max")
    assert [key for key in NUMBERS if any(word in key for word in odd)] == []
