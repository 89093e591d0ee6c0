"""What the parameter models of all stages have in common."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Parameters(BaseModel):
    """Parameters of one stage: never changed, no key unknown, no number infinite; every field states its bounds."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
