"""What can be wrong with an experiment."""

from __future__ import annotations

from rotor_fmu.model.refusal import Refusal


class ImpactError(Refusal, ValueError):
    """An experiment that cannot be; names the thing, its value and what is allowed."""
