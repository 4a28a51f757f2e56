"""The class of all errors in what a user gives, and how text from a file is shown on one line."""


def printable(text: str) -> str:
    """Return the text on one line; characters that are not printed, as Python writes them."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


class InputError(ValueError):
    """Invalid input; the message names it, its value and what is allowed.

    >>> import rotor_fmu as rf
    >>> try:
    ...     rf.simulate(rf.load(), speed=185.0, stop=-1.0)
    ... except rf.InputError as error:
    ...     print(error)
    stop = -1 s: must be > 0 and finite
    """

    def __init__(self, message: str) -> None:
        """Take the message; names in it may come from a file and hold line breaks."""
        super().__init__(printable(message))
