"""What can be wrong with an experiment."""

from __future__ import annotations

from rotor_fmu.model.errors import UserInputError


class ImpactError(UserInputError, ValueError):
    """An experiment that cannot be; names the thing, its value and what is allowed."""
