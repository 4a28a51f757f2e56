"""Numbers in little room: whole steps of a range, their differences, compressed, as text.

A page has to hold a million samples in a few MB. Values are counted in steps of their range, 2^16
or 2^24 of them; a smooth signal's differences are small; their bytes, low ones first, compress
well. A browser undoes it with what it has built in.
"""

import base64
import zlib
from typing import Any

import numpy as np

COARSE, FINE = 16, 24  # bits: a screen's resolution; what a number is read by
_MOST_DIFFERENCES = 2
_SAMPLE = 20_000  # values by which the number of differences is chosen


def packed(values: np.ndarray, bits: int = FINE) -> dict[str, Any]:
    """Pack real values of any shape, flattened, within half a step of (max - min) / (2^bits - 2).

    What is not finite comes back as NaN. Keys: n, bits, low and step of the counts, how often
    differences were taken, data in base64.
    """
    flat = np.asarray(values, float).ravel()
    is_finite = np.isfinite(flat)
    known = flat[is_finite]
    low = float(known.min()) if len(known) else 0.0
    top = 2**bits - 1  # stands for NaN
    step = (float(known.max()) - low) / (top - 1) if len(known) else 0.0
    counts = np.full(len(flat), top, np.uint32)
    if len(known):
        counts[is_finite] = np.rint((known - low) / step) if step > 0 else 0
    tried = [counts]
    for _ in range(_MOST_DIFFERENCES):
        # modulo 2^bits nothing is lost
        tried.append(np.diff(tried[-1], prepend=np.uint32(0)) & np.uint32(top))
    some = slice(len(flat) // 2, len(flat) // 2 + _SAMPLE)
    lengths = [len(zlib.compress(_planes(each[some], bits), 1)) for each in tried]
    differences = int(np.argmin(lengths))
    data = zlib.compress(_planes(tried[differences], bits), 6)
    return {
        "n": len(flat),
        "bits": bits,
        "low": low,
        "step": step,
        "differences": differences,
        "data": base64.b64encode(data).decode("ascii"),
    }


def _planes(counts: np.ndarray, bits: int) -> bytes:
    shifted = (counts >> np.uint32(shift) for shift in range(0, bits, 8))
    return b"".join(each.astype(np.uint8).tobytes() for each in shifted)
