"""Other programs talk while they are loaded, some past Python: nothing of that on the screen."""

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Nothing reaches standard output and error from here, whoever writes it."""
    sys.stdout.flush()
    sys.stderr.flush()
    stored = [os.dup(number) for number in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in (1, 2):
            os.dup2(nowhere, number)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, before in zip((1, 2), stored, strict=True):
            os.dup2(before, number)
            os.close(before)
        os.close(nowhere)
