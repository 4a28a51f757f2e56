"""An FMU's state as bytes: checked when it is read, so that no other build's, truncated or
corrupted state is taken."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

_DIGEST = hashlib.sha256().digest_size


class StateError(ValueError):
    """Bytes that are no state of this FMU."""


def pack(build: str, about: dict[str, Any], arrays: Sequence[np.ndarray]) -> bytes:
    """State of the FMU build `build`: what JSON can say, and arrays."""
    header = {"build": build, "about": about, "sizes": [a.nbytes for a in arrays]}
    text = json.dumps(header).encode()
    body = len(text).to_bytes(8, "little") + text + b"".join(a.tobytes() for a in arrays)
    return hashlib.sha256(body).digest() + body


def unpack(build: str, state: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """What `pack` was given, the arrays as bytes; `StateError` if it was not by this build."""
    digest, body = state[:_DIGEST], state[_DIGEST:]
    if hashlib.sha256(body).digest() != digest:
        raise StateError("the FMU state is truncated or corrupted")
    length = int.from_bytes(body[:8], "little")
    header = json.loads(body[8 : 8 + length])
    if header["build"] != build:
        raise StateError("the FMU state comes from another build of this FMU")
    chunks, at = [], 8 + length
    for size in header["sizes"]:
        chunks.append(body[at : at + size])
        at += size
    return header["about"], chunks
