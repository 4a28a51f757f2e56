"""Machine files with changes at random, and what becomes of them: a machine that runs, or one plain
line."""

import random
import re
import signal
import warnings
from contextlib import contextmanager

from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.simulation import EquilibriumError, StepFailure

from rotor_fmu.errors import InputError

REFUSALS = (QuantityError, InputError, EquilibriumError, StepFailure)
LIMIT = 60  # a file takes some hundredths of a second [s]
ODD = (
    "0", "-1", "1e-300", "1e300", "-1e-12", "nan", "inf", "-inf", "1e20", "true", '"word"', "[]",
    "{}", "[1.0, 2.0]", '""', "1979-05-27", "99999999999999999999", "0.5", "3", "1e-9", "1e9",
)  # fmt: skip


def mutated(bases, seed):
    """One of some machine files with one to three changes."""
    rng = random.Random(seed)
    lines = rng.choice(bases).splitlines()
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(lines))
        key, equals, value = lines[at].partition("=")
        kind = rng.randrange(8)
        if kind <= 2 and equals:
            numbers = list(re.finditer(r"-?\d[\d.e+-]*", value))
            if numbers and rng.random() < 0.7:
                result = rng.choice(numbers)
                value = f"{value[: result.start()]}{rng.choice(ODD)}{value[result.end() :]}"
            else:
                value = f" {rng.choice(ODD)}"
            lines[at] = f"{key}={value}"
        elif kind == 3:
            del lines[at]
        elif kind == 4:
            lines.insert(rng.randrange(len(lines)), lines[at])
        elif kind == 5 and len(lines[at]) > 1:
            place = rng.randrange(len(lines[at]))
            lines[at] = lines[at][:place] + rng.choice("xX.[]{}=\"'#9 ") + lines[at][place + 1 :]
        elif kind == 6:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        else:
            begins = [i for i, line in enumerate(lines) if line.startswith("[")]
            begin = rng.choice(begins)
            end = next((i for i in begins if i > begin), len(lines))
            if rng.random() < 0.5:
                del lines[begin:end]
            else:
                lines += lines[begin:end]
        lines = lines or [""]
    return "\n".join(lines)


def one_line(message):
    """What is said, in one line."""
    assert str(message)
    assert "\n" not in str(message)
    return str(message)


def outcome_of(text, use):
    """The refusal of a machine file in one line, None where `use` goes through."""
    signal.alarm(LIMIT)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            use(text)
    except REFUSALS as error:
        return one_line(error)
    finally:
        signal.alarm(0)
    return None


def outcomes(bases, use, seeds):
    """The outcomes of the mutated files of some seeds; a file that takes too long ends them."""
    with ending_hangs():
        return [outcome_of(mutated(bases, seed), use) for seed in seeds]


@contextmanager
def ending_hangs():
    """A file that takes too long ends what runs within."""

    def end(number, frame):
        raise TimeoutError(f"a file took more than {LIMIT} s")

    before = signal.signal(signal.SIGALRM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGALRM, before)
