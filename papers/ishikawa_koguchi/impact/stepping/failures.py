"""What can be wrong with an experiment."""

from rotor_fmu.model.errors import InputError


class ImpactError(InputError):
    """An experiment that cannot be; names the thing, its value and what is allowed."""
