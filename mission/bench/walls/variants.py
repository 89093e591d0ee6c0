"""What a benchmark run can vary: stages switched off (Table 5), parameters swept (Table 6)."""

from __future__ import annotations

from typing import Any

from mission.config import MissionConfig

Variant = str | float
"""Name of a variant, or the value of the swept parameter."""

PLAIN = "as configured"
ABLATIONS: dict[str, dict[str, Any]] = {
    "highlights": {"correct_highlights": False},
    "flash": {"normalise_flash": False},
}
"""Parameters of the detector that leave a stage out."""
SWEEPS: dict[str, tuple[str, float]] = {
    "delta": ("delta", 1.0),
    "alpha1": ("alpha1", 1.0),
    "alpha2": ("alpha2", 1.0),
    "alpha3": ("alpha3", 0.1),
    "sigma": ("max_sigma", 0.5),
}
"""By the paper's name: the parameter, and rho of Table 6, of which 0.1 to 0.9 are tried (that of sigma is ours)."""


def variants(config: MissionConfig, *, ablate: str | None, sweep: str | None) -> dict[Variant, MissionConfig]:
    """The configurations to compare; just the given one where nothing is varied."""
    if sweep:
        name, rho = SWEEPS[sweep]
        values = [round(rho * tenth / 10, 4) for tenth in range(1, 10)]
        return {value: _changed(config, {name: value}) for value in values}
    plain: dict[Variant, MissionConfig] = {PLAIN: config}
    return plain | ({f"without {ablate}": _changed(config, ABLATIONS[ablate])} if ablate else {})


def configured(config: MissionConfig, sweep: str) -> float:
    """The value that the swept parameter has without a sweep."""
    return float(getattr(config.detector, SWEEPS[sweep][0]))


def _changed(config: MissionConfig, parameters: dict[str, Any]) -> MissionConfig:
    return config.model_copy(update={"detector": config.detector.model_copy(update=parameters)})
