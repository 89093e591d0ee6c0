"""Configurations: defaults, files, settings, and what is said when one is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from mission.config import MissionConfig, read_config
from mission.errors import UsageError


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
    ],
)
def test_a_wrong_setting_is_named_in_one_line(setting: str, said: str) -> None:
    with pytest.raises(UsageError) as caught:
        read_config(None, [setting])
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


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
