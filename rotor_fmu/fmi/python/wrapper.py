"""Workarounds for pythonfmu's native wrapper (0.7.0), without which it crashes its host."""

import ctypes
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

INTERRUPTED = "interrupted by the user"
_settled: set[str] = set()


class CallFailed(RuntimeError):
    """A call that failed; its message goes to the host."""

    def __repr__(self) -> str:
        """Return the sentence alone: the wrapper logs the representation."""
        return str(self)


def hold(*objects: object) -> None:
    """Take one more reference to each object.

    The wrapper drops its references to the instance, its log queue and its class whenever an
    exception leaves a callback, and once more at the end.
    """
    for item in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(item))


def held(slave: Any) -> None:
    """Take the references that the wrapper drops when the exception being handled leaves the
    `slave`.

    The wrapper hands queued messages to the host's logger, which may itself be Python, while the
    exception is pending: so the queue is emptied, and the exception is the message.
    """
    slave.log_queue.clear()
    hold(slave, slave.log_queue, type(slave))


def in_one_line(message: str) -> str:
    """Return a message in one line and without percent signs, which hosts' loggers read as a
    format."""
    return " ".join(message.replace("%", " percent").split())


def escaped(message: str) -> str:
    """Return a message as FMI's loggers read it: `#` is an escape character, which stands before
    references to variables and itself."""
    return message.replace("#", "##")


class HeldFromLookUp:
    """A method of a slave that the wrapper may fail to call, as with a state that is NULL.

    No exception leaves Python then, but the wrapper drops its references all the same; so they are
    taken when it looks the method up, and given back when the call arrives.
    """

    def __init__(self, method: Callable[..., object]) -> None:
        self._method = method

    def __get__(self, slave: Any, owner: type) -> object:
        """Return the bound method; on the class this descriptor."""
        if slave is None:
            return self
        references = slave, slave.log_queue, type(slave)
        hold(*references)

        def call(*arguments: object) -> object:
            for item in references:
                ctypes.pythonapi.Py_DecRef(ctypes.py_object(item))
            return self._method(slave, *arguments)

        return call


def settle_exit(resources: str | None) -> None:
    """Let the wrapper in `resources`/.. be torn down once at the end of the process, not twice.

    At exit its global state is destroyed as a C++ object and then by a destructor function that
    takes it for alive: that writes into freed memory, and now and then the host ends in an abort.
    A handler registered now runs before both and leaves them nothing to destroy. The library is
    kept loaded until then, as it stays anyway.
    """
    if not sys.platform.startswith("linux") or resources is None or resources in _settled:
        return
    for library in Path(resources).parent.glob("binaries/linux64/*.so"):
        try:
            wrapper = ctypes.CDLL(str(library), mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
            finalize = ctypes.cast(wrapper.finalizePythonInterpreter, ctypes.c_void_p)
            ctypes.CDLL(None).__cxa_atexit(finalize, None, None)
        except (OSError, AttributeError):
            continue  # not loaded, as when the FMU is being built, or another version
        _settled.add(resources)
