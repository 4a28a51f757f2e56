"""Frequencies, damping ratio and logarithmic decrement from eigenvalues."""

import numpy as np


class Spectrum:
    """A result with complex `eigenvalues` lambda [rad/s] of any shape; what follows has it too."""

    eigenvalues: np.ndarray

    @property
    def damped(self) -> np.ndarray:
        """Frequencies at which the modes vibrate, omega_d [rad/s]."""
        return self.eigenvalues.imag

    @property
    def natural(self) -> np.ndarray:
        """omega_n = |lambda| [rad/s]."""
        return np.abs(self.eigenvalues)

    @property
    def damping_ratio(self) -> np.ndarray:
        """zeta [1]; negative: the mode grows."""
        return -self.eigenvalues.real / self.natural

    @property
    def log_dec(self) -> np.ndarray:
        """Logarithmic decrement 2 pi zeta / sqrt(1 - zeta^2) [1]."""
        return -2 * np.pi * self.eigenvalues.real / self.eigenvalues.imag
