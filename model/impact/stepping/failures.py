"""What can be wrong with an experiment."""

from __future__ import annotations


class ImpactError(ValueError):
    """An experiment that cannot be; names the thing, its value and what is allowed."""
