"""Real Fourier series, represented by their coefficients [mean, cos 1, sin 1, cos 2, ...] along the
first axis."""

import numpy as np
from numpy.lib.stride_tricks import as_strided


def basis(H: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the H harmonics of a series at angles [rad], and their derivatives by the angle, shape
    (n, 2 H + 1) each."""
    k = np.arange(1, H + 1)
    turned = np.cumprod(np.repeat(np.exp(1j * angles)[:, None], H, axis=1), axis=1)
    value, slope = np.zeros((2, len(angles), 2 * H + 1))
    value[:, 0] = 1.0
    value[:, 1:], slope[:, 1:] = turned.view(float), (1j * k * turned).view(float)
    return value, slope


def projection(value: np.ndarray) -> np.ndarray:
    """Return the matrix from evenly spaced samples over a turn to coefficients, shape (2 H + 1,
    n)."""
    weights = np.full(value.shape[1], 2.0 / len(value))
    weights[0] = 1.0 / len(value)
    return weights[:, None] * value.T


def sampled(series: np.ndarray, n: int) -> np.ndarray:
    """Return the values of a series at n evenly spaced angles, along the first axis; n > 2 H."""
    spectrum = np.zeros((n // 2 + 1, *series.shape[1:]), complex)
    spectrum[: len(series) // 2 + 1] = amplitudes(series) * (0.5 * n)
    spectrum[0] *= 2.0
    return np.fft.irfft(spectrum, n, axis=0)


def series_of(spectrum: np.ndarray) -> np.ndarray:
    """Return the real coefficients of complex Fourier coefficients 0 to H, along the first axis."""
    amplitude = 2.0 * spectrum
    amplitude[0] *= 0.5
    return coefficients(amplitude)


def amplitudes(coefficients: np.ndarray) -> np.ndarray:
    """Return the complex amplitudes of harmonics 0 to H, x = Re(sum x_k exp(i k t)), along the
    first axis."""
    out = np.zeros((len(coefficients) // 2 + 1, *coefficients.shape[1:]), complex)
    out[0] = coefficients[0]
    out.real[1:], out.imag[1:] = coefficients[1::2], -coefficients[2::2]
    return out


def coefficients(amplitude: np.ndarray) -> np.ndarray:
    """Return the real coefficients of complex amplitudes (inverse of `amplitudes`)."""
    out = np.zeros((2 * len(amplitude) - 1, *amplitude.shape[1:]))
    out[0] = amplitude[0].real
    out[1::2], out[2::2] = amplitude[1:].real, -amplitude[1:].imag
    return out


def add_real(matrix: np.ndarray, S: np.ndarray) -> None:
    """Add complex matrices of harmonics 0 to H, shape (H + 1, b, b), to a matrix of coefficients,
    shape (2 H + 1, b, 2 H + 1, b)."""
    matrix[0, :, 0] += S[0].real
    cosine, real, imag = 2 * np.arange(1, len(S)) - 1, S[1:].real, S[1:].imag
    sine = cosine + 1
    on_diagonal = (cosine, cosine, real), (sine, sine, real)
    for row, column, part in (*on_diagonal, (cosine, sine, imag), (sine, cosine, -imag)):
        matrix[row, :, column] += part


def products(of_value: np.ndarray, of_rate: np.ndarray) -> np.ndarray:
    """Return the matrix that takes the coefficients of a series x to those of T x + V x', truncated
    at H harmonics, shape (2 H + 1, p, 2 H + 1, q); of_value, of_rate: complex Fourier coefficients
    0 to 2 H of the matrices T and V, shape (2 H + 1, p, q); x' is the derivative by the angle."""
    H, (p, q) = len(of_value) // 2, of_value.shape[1:]
    out = np.empty((2 * H + 1, p, 2 * H + 1, q))
    k = np.arange(H + 1)[:, None]
    value_minus, value_plus = _by_differences(of_value)
    rate_minus, rate_plus = _by_differences(of_rate)
    # of x = Re(z exp(i k t)): T_(j-k) z + T_(j+k) conj z
    both, apart = value_minus + value_plus, value_minus - value_plus
    both += 1j * k * (rate_minus - rate_plus)
    apart += 1j * k * (rate_minus + rate_plus)
    out[0, :, 0] = of_value[0].real
    out[0, :, 1::2], out[0, :, 2::2] = 0.5 * both.real[0, :, 1:], 0.5 * apart.imag[0, :, 1:]
    out[1::2, :, 0], out[2::2, :, 0] = 2 * of_value.real[1 : H + 1], -2 * of_value.imag[1 : H + 1]
    out[1::2, :, 1::2], out[2::2, :, 1::2] = both.real[1:, :, 1:], -both.imag[1:, :, 1:]
    out[1::2, :, 2::2], out[2::2, :, 2::2] = apart.imag[1:, :, 1:], apart.real[1:, :, 1:]
    return out


def _by_differences(spectrum: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the coefficients j - k and j + k of a real function, for j and k from 0 to H, shape (H
    + 1, p, H + 1, q) each, as views."""
    H = len(spectrum) // 2
    whole = np.concatenate([spectrum[:0:-1].conj(), spectrum])[H:]
    first, p, q = whole.strides
    shape = (H + 1, spectrum.shape[1], H + 1, spectrum.shape[2])
    minus = as_strided(whole[H:], shape, (first, p, -first, q), writeable=False)
    return minus, as_strided(whole[H:], shape, (first, p, first, q), writeable=False)


def derivative(series: np.ndarray) -> np.ndarray:
    """Return the coefficients of the derivative by the angle, along the first axis."""
    out = np.zeros_like(series)
    k = np.arange(1, len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    out[1::2], out[2::2] = k * series[2::2], -k * series[1::2]
    return out


def times_derivative(matrices: np.ndarray, series: np.ndarray) -> np.ndarray:
    """Return the coefficients 0 to H of matrices, given by their spectrum 0 to 2 H, times the
    derivative of a series by the angle."""
    return np.tensordot(products(0 * matrices, matrices), series, 2)


def repeated(series: np.ndarray, count: int) -> np.ndarray:
    """Return the coefficients of the same motion with `count` of its periods as one, along the
    first axis."""
    if count == 1:
        return series
    out = np.zeros((count * (len(series) - 1) + 1, *series.shape[1:]))
    k = count * np.arange(1, len(series) // 2 + 1)
    out[0], out[2 * k - 1], out[2 * k] = series[0], series[1::2], series[2::2]
    return out


def shifted(series: np.ndarray, angle: float) -> np.ndarray:
    """Return the coefficients of the motion that is ahead by an angle [rad], along the first
    axis."""
    k = np.arange(len(series) // 2 + 1).reshape(-1, *[1] * (series.ndim - 1))
    return coefficients(amplitudes(series) * np.exp(1j * k * angle))


def resized(series: np.ndarray, H: int) -> np.ndarray:
    """Return the coefficients of a series truncated or extended to H harmonics, along the first
    axis."""
    out = np.zeros((2 * H + 1, *series.shape[1:]))
    n = min(len(out), len(series))
    out[:n] = series[:n]
    return out


def last_share(b: np.ndarray) -> float:
    """Return the amplitude of the highest harmonics of a series relative to its largest
    harmonic."""
    size, H = np.abs(amplitudes(b)).max(axis=1, initial=0.0), len(b) // 2
    last = max(2, H // 4)
    return float(size[-last:].max() / max(size[1:].max(), 1e-300)) if last < H else 1.0
