"""Real Fourier series by their coefficients [mean, cos 1, sin 1, cos 2, ...], harmonics first."""

from __future__ import annotations

import numpy as np


def basis(H: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The functions of a series of H harmonics at angles [rad], and their derivatives by the angle,
    each of shape (n, 2 H + 1)."""
    k = np.arange(1, H + 1)
    c, s = np.cos(np.outer(angles, k)), np.sin(np.outer(angles, k))
    value, slope = np.zeros((2, len(angles), 2 * H + 1))
    value[:, 0] = 1.0
    value[:, 1::2], value[:, 2::2] = c, s
    slope[:, 1::2], slope[:, 2::2] = -k * s, k * c
    return value, slope


def projection(value: np.ndarray) -> np.ndarray:
    """From samples evenly over a turn to coefficients, shape (2 H + 1, n)."""
    weights = np.full(value.shape[1], 2.0 / len(value))
    weights[0] = 1.0 / len(value)
    return weights[:, None] * value.T


def sampled(series: np.ndarray, n: int) -> np.ndarray:
    """Series at n angles evenly over a turn, along the first axis; n > 2 H."""
    spectrum = np.zeros((n // 2 + 1, *series.shape[1:]), complex)
    spectrum[: len(series) // 2 + 1] = amplitudes(series) * (0.5 * n)
    spectrum[0] *= 2.0
    return np.fft.irfft(spectrum, n, axis=0)


def series_of(samples: np.ndarray, H: int) -> np.ndarray:
    """Coefficients of samples evenly over a turn, cut off at H harmonics, along the first axis."""
    spectrum = np.fft.rfft(samples, axis=0)[: H + 1] * (2.0 / len(samples))
    spectrum[0] *= 0.5
    return coefficients(spectrum)


def amplitudes(coefficients: np.ndarray) -> np.ndarray:
    """Complex amplitudes of harmonics 0 to H, x = Re(sum x_k exp(i k t)), along the first axis."""
    out = np.zeros((len(coefficients) // 2 + 1, *coefficients.shape[1:]), complex)
    out[0] = coefficients[0]
    out[1:] = coefficients[1::2] - 1j * coefficients[2::2]
    return out


def coefficients(amplitude: np.ndarray) -> np.ndarray:
    """The other way round."""
    out = np.zeros((2 * len(amplitude) - 1, *amplitude.shape[1:]))
    out[0] = amplitude[0].real
    out[1::2], out[2::2] = amplitude[1:].real, -amplitude[1:].imag
    return out


def as_real(S: np.ndarray) -> np.ndarray:
    """Complex matrices of harmonics 0 to H, shape (H + 1, b, b), as a matrix of coefficients, shape
    ((2 H + 1) b, (2 H + 1) b)."""
    count, b, _ = S.shape
    out = np.zeros((2 * count - 1, b, 2 * count - 1, b))
    out[0, :, 0] = S[0].real
    k = np.arange(1, count)
    out[2 * k - 1, :, 2 * k - 1] = out[2 * k, :, 2 * k] = S[1:].real
    out[2 * k - 1, :, 2 * k] = S[1:].imag
    out[2 * k, :, 2 * k - 1] = -S[1:].imag
    return out.reshape((2 * count - 1) * b, -1)


def multiplication(samples: np.ndarray, H: int) -> np.ndarray:
    """What multiplication by functions of the angle makes of the coefficients of a series, cut off
    at H harmonics; samples: evenly over a turn, shape (n, ...), n > 4 H; shape (2 H + 1, 2 H + 1,
    ...).
    """
    spectrum = np.fft.rfft(samples, axis=0)[: 2 * H + 1] / len(samples)
    c, s = spectrum.real, -spectrum.imag
    k = np.arange(1, H + 1)
    plus, minus = k[:, None] + k, k[:, None] - k
    sign = np.sign(minus).reshape(*minus.shape, *[1] * (samples.ndim - 1))
    c_minus, s_minus = c[np.abs(minus)], sign * s[np.abs(minus)]
    out = np.empty((2 * H + 1, 2 * H + 1, *samples.shape[1:]))
    out[0, 0] = c[0]
    out[0, 1::2], out[0, 2::2] = c[k], s[k]
    out[1::2, 0], out[2::2, 0] = 2 * c[k], 2 * s[k]
    out[1::2, 1::2], out[2::2, 2::2] = c_minus + c[plus], c_minus - c[plus]
    out[1::2, 2::2], out[2::2, 1::2] = s[plus] - s_minus, s[plus] + s_minus
    return out


def derivative(series: np.ndarray) -> np.ndarray:
    """Coefficients of the derivative by the angle, along the first axis."""
    out = np.zeros_like(series)
    k = np.arange(1, len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    out[1::2], out[2::2] = k * series[2::2], -k * series[1::2]
    return out


def after_derivative(matrix: np.ndarray) -> np.ndarray:
    """A matrix of coefficients, shape (rows, 2 H + 1, ...), applied to the derivative of a
    series."""
    out = np.zeros_like(matrix)
    k = np.arange(1, matrix.shape[1] // 2 + 1).reshape(-1, *[1] * (matrix.ndim - 2))
    out[:, 2::2], out[:, 1::2] = k * matrix[:, 1::2], -k * matrix[:, 2::2]
    return out


def repeated(series: np.ndarray, count: int) -> np.ndarray:
    """Coefficients of the same motion over so many periods as one, along the first axis."""
    if count == 1:
        return series
    out = np.zeros((count * (len(series) - 1) + 1, *series.shape[1:]))
    k = count * np.arange(1, len(series) // 2 + 1)
    out[0], out[2 * k - 1], out[2 * k] = series[0], series[1::2], series[2::2]
    return out


def shifted(series: np.ndarray, angle: float) -> np.ndarray:
    """Coefficients of the motion by an angle [rad] later, along the first axis."""
    k = np.arange(len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    return coefficients(amplitudes(series) * np.exp(1j * k * angle))


def resized(series: np.ndarray, H: int) -> np.ndarray:
    """Coefficients with as many harmonics as wanted, along the first axis."""
    out = np.zeros((2 * H + 1, *series.shape[1:]))
    n = min(len(out), len(series))
    out[:n] = series[:n]
    return out
