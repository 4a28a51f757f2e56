"""The few functions beyond the square root that the kernels need, made of sums and products alone.

Every system's library rounds them in its own way, and a run amplifies a difference in the last bit;
these give the same numbers wherever arithmetic is IEEE's. Polynomials: Chebyshev fits of the
remainders of the series, in the square of the argument.
"""

import math

from .jit import jit, jit_not_inlined

# pi / 2 in parts of 33 bits, whose products with an integer of 20 bits are exact, and the rest.
_PARTS = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
_SPLIT = 134217729.0  # 2^27 + 1 cuts a number into halves whose products are exact (Veltkamp)


@jit
def modulus(z):
    """Return |z| of a complex number that neither overflows nor underflows when it is squared."""
    return math.sqrt(z.real * z.real + z.imag * z.imag)


@jit
def scaled(factor, z):
    """Return the product of a real and a complex number. `factor * z` would make the factor complex
    and multiply by its zeros as well, which costs time in a loop over all dofs."""
    return complex(factor * z.real, factor * z.imag)


@jit
def copy(values, out):
    """Fill `out` with as many first values: an assignment to a slice would count references."""
    for i in range(len(out)):
        out[i] = values[i]


@jit
def inverse(z):
    """Return 1 / z of a complex number that neither overflows nor underflows when it is squared.
    Languages and libraries round the division of complex numbers differently; this is the same in
    all."""
    return z.conjugate() * (1.0 / (z.real * z.real + z.imag * z.imag))


@jit
def _sum(a, b):
    """Return a + b and its rounding error (Knuth)."""
    s = a + b
    added = s - a
    return s, (a - (s - added)) + (b - added)


@jit
def _product(a, b):
    """Return a b and its rounding error (Dekker)."""
    p = a * b
    wide = _SPLIT * a
    a_high = wide - (wide - a)
    a_low = a - a_high
    wide = _SPLIT * b
    b_high = wide - (wide - b)
    b_low = b - b_high
    return p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low


@jit
def _reduced(theta):
    """Return n modulo 4, r and low, with theta = n pi / 2 + r + low and |r| <= pi / 4; 0 <= theta
    <= 1e12."""
    n = int(theta * 0.6366197723675814 + 0.5)
    n_low = float(n % 1048576)
    n_high = float(n) - n_low
    r = (theta - n_high * _PARTS[0]) - n_low * _PARTS[0]
    low = 0.0
    for i in (1, 2):
        for factor in (n_high, n_low):
            r, lost = _sum(r, -factor * _PARTS[i])
            low += lost
    r, low = _sum(r, low)
    return n % 4, r, low


@jit
def direction(theta):
    """Return exp(i theta), each part below 1 ulp; |theta| up to 1e12, NaN beyond."""
    if not abs(theta) <= 1e12:
        return complex(math.nan, math.nan)
    quarter, r, low = _reduced(abs(theta))
    z = r * r
    tail = -2.5052106231157904e-08 + z * (1.605853141458901e-10 - z * 7.586685070091267e-13)
    tail = -0.0001984126984126506 + z * (2.7557319219335453e-06 + z * tail)
    tail = -0.16666666666666666 + z * (0.008333333333333331 + z * tail)
    sine = r + (r * z * tail + low * (1.0 - 0.5 * z))
    tail = -2.7557317270560326e-07 + z * (2.0876146024689747e-09 - z * 1.1382614868556325e-11)
    tail = -0.0013888888888887395 + z * (2.4801587298763433e-05 + z * tail)
    tail = 0.041666666666666664 + z * tail
    rest = 1.0 - 0.5 * z
    cosine = rest + (((1.0 - rest) - 0.5 * z) + (z * z * tail - r * low))
    if quarter == 1 or quarter == 3:
        cosine, sine = -sine, cosine
    if quarter >= 2:
        cosine, sine = -cosine, -sine
    return complex(cosine, sine if theta >= 0.0 else -sine)


# arctan(k / 16), k = 0 .. 16, and its rounding error
_ARCTAN = (
    (0.0, 0.0),
    (0.06241880999595735, -1.5490756308295046e-18),
    (0.12435499454676144, -3.1253241424539383e-18),
    (0.18534794999569476, 4.180692268843079e-18),
    (0.24497866312686414, 1.0698755618734451e-17),
    (0.3028848683749714, -1.1010827903001369e-17),
    (0.35877067027057225, -2.4623815582638635e-17),
    (0.4124104415973873, -1.587652227770689e-17),
    (0.4636476090008061, 2.2698777452961687e-17),
    (0.5123894603107377, -2.5462781472855804e-17),
    (0.5585993153435624, -5.4556305485916264e-18),
    (0.6022873461349642, 2.950430737228402e-17),
    (0.6435011087932844, 1.5834785051444286e-17),
    (0.6823165548747481, 6.943223671560008e-18),
    (0.7188299996216245, -2.1478388444456983e-17),
    (0.7531512809621944, -2.4256934659182068e-17),
    (0.7853981633974483, 3.061616997868383e-17),
)


@jit
def _arctan_of_ratio(a, b):
    """Return arctan(a / b) of 0 <= a <= b, b > 0; NaN of what is none."""
    ratio = a / b
    if not ratio >= 0.0:
        return math.nan, math.nan
    k = int(16.0 * ratio + 0.5)
    c = k * 0.0625
    # arctan(a / b) - arctan(c) = arctan((a - c b) / (b + c a))
    product, lost = _product(c, b)
    top, top_low = _sum(a, -product)
    top_low -= lost
    product, lost = _product(c, a)
    bottom, bottom_low = _sum(b, product)
    bottom_low += lost
    u = (top + top_low) / bottom
    product, lost = _product(u, bottom)
    low = (((top - product) - lost + top_low) - u * bottom_low) / bottom
    z = u * u
    tail = 0.11110845894072896 - z * 0.0901470699496019
    tail = -0.3333333333333332 + z * (0.19999999999812218 + z * (-0.14285713908578174 + z * tail))
    high, rest = _sum(_ARCTAN[k][0], u)
    return high, rest + (_ARCTAN[k][1] + (low + u * z * tail))


@jit_not_inlined
def angle(z):
    """Return the angle of a complex number from the right, in (-pi, pi], below 1 ulp; 0 of 0."""
    a, b = abs(z.imag), abs(z.real)
    if not (a > 0.0 or b > 0.0):
        return 0.0 if a == b else math.nan
    if a <= b:
        high, low = _arctan_of_ratio(a, b)
    else:
        high, low = _arctan_of_ratio(b, a)
        high, rest = _sum(1.5707963267948966, -high)
        low = rest + (6.123233995736766e-17 - low)
    if z.real < 0.0:
        high, rest = _sum(3.141592653589793, -high)
        low = rest + (1.2246467991473532e-16 - low)
    return -(high + low) if z.imag < 0.0 else high + low


@jit
def _power_of_two(n):
    """Return 2^n, exactly; `2.0**n` would be the system's exp2."""
    y, factor, left = 1.0, 2.0 if n >= 0 else 0.5, abs(n)
    while left > 0:
        if left % 2 == 1:
            y *= factor
        factor *= factor
        left //= 2
    return y


# Parabolas for the cube root in 1 to 8 and the fifth root in 1 to 32, within 2 and 5 per cent.
_NEAR_CUBE_ROOT = (0.7625, 0.2681, -0.0147)
_NEAR_FIFTH_ROOT = (0.974, 0.0762, -0.0015)


@jit
def cube_root(x):
    """Return the cube root of x >= 0 within 2 ulp."""
    return _root(x, 3, _NEAR_CUBE_ROOT)


@jit
def fifth_root(x):
    """Return the fifth root of x >= 0 within 2 ulp."""
    return _root(x, 5, _NEAR_FIFTH_ROOT)


@jit
def _root(x, n, near):
    """Return the n-th root of x >= 0, n = 3 or 5: twice by Halley's method, whose error is of third
    order, and once by Newton's, whose correction is rounded and not its result."""
    if not 0.0 < x < math.inf:
        return x
    factor = _power_of_two(n)
    scale = 1.0
    while x >= factor:
        x /= factor
        scale *= 2.0
    while x < 1.0:
        x *= factor
        scale *= 0.5
    y = near[0] + x * (near[1] + x * near[2])
    for _ in range(2):
        power = y * y * y if n == 3 else y * y * y * y * y
        y *= ((n - 1) * power + (n + 1) * x) / ((n + 1) * power + (n - 1) * x)
    power = y * y if n == 3 else y * y * y * y
    y -= (y - x / power) * (1.0 / n)
    return scale * y


_LN2 = (0.6931471803691238, 1.9082149292705877e-10)  # ln 2 in a part of 32 bits, and the rest


@jit_not_inlined
def exponential(x):
    """Return exp(x), within 2 ulp; 0 below -700, infinite above 700."""
    if not -700.0 <= x <= 700.0:
        return math.inf if x > 0.0 else 0.0 if x < 0.0 else math.nan
    n = math.floor(x * 1.4426950408889634 + 0.5)
    r = (x - n * _LN2[0]) - n * _LN2[1]
    tail = 1.0
    for k in range(14, 0, -1):
        tail = 1.0 + r * tail / k
    return tail * _power_of_two(n)


@jit_not_inlined
def logarithm(x):
    """Return ln x of x > 0, within 4 ulp of the larger of it and 1."""
    if not 0.0 < x < math.inf:
        return -math.inf if x == 0.0 else math.inf if x > 0.0 else math.nan
    n = 0
    while x >= 1.5:
        x *= 0.5
        n += 1
    while x < 0.75:
        x *= 2.0
        n -= 1
    s = (x - 1.0) / (x + 1.0)
    z = s * s
    tail = 0.0
    for k in range(25, 0, -2):
        tail = 1.0 / k + z * tail
    return n * _LN2[0] + (n * _LN2[1] + 2.0 * s * tail)


@jit_not_inlined
def power(x, y):
    """Return x^y of x >= 0, to 4 ulp times the logarithm of the result; exact where y is 0 or 1,
    the root where it is 1/2."""
    if y == 0.0:
        return 1.0
    if y == 1.0:
        return x
    if y == 0.5:
        return math.sqrt(x)
    return exponential(y * logarithm(x)) if x > 0.0 else 0.0
