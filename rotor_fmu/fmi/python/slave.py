"""The FMI 2.0 slave: pythonfmu's class as a thin layer, each call of which is forwarded to the
function of FMI 2.0 in the library beside this file.

Standard library and pythonfmu only: a host needs nothing beside Python.
"""

import ctypes
import hashlib
import sys
from array import array
from collections.abc import Callable
from contextlib import suppress
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_void_p
from functools import wraps
from pathlib import Path
from struct import Struct
from typing import Any

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from . import CHECKSUMS
from .wrapper import (
    INTERRUPTED,
    CallFailed,
    HeldFromLookUp,
    escaped,
    held,
    in_one_line,
    settle_exit,
)

TABLE = "machine.table"  # the machine, in an FMU's resources
_LIBRARIES = {"linux": "linux64.so", "win32": "win64.dll"}
_MOST_ROOMS = 64
_WARNING, _DISCARD = 1, 2  # of FMI's statuses


@ctypes.CFUNCTYPE(None, ctypes.py_object, c_int, c_char_p)
def _hear(received: list[tuple[int, str]], status: int, message: bytes) -> None:
    received.append((status, message.decode(errors="replace")))


def _loaded() -> Any:
    """Return the library for this system, or why there is none."""
    file = Path(__file__).with_name(_LIBRARIES.get(sys.platform, "none"))
    if not file.is_file():
        return (
            f"this FMU carries no library for {sys.platform}; build it with one: rotor-fmu build "
            "--platform linux64 --platform win64"
        )
    # a file whose end is missing would end the host in the system's loader
    if hashlib.sha256(file.read_bytes()).hexdigest() != CHECKSUMS.get(file.name):
        return f"the FMU's library is damaged: {file.name} is not what was built"
    try:
        library = ctypes.CDLL(str(file))  # its calls let other threads run meanwhile
    except OSError as error:
        return f"the FMU's library cannot be loaded: {error}"
    instance, values = c_void_p, (c_void_p, c_void_p, c_size_t, c_void_p)
    library.rotor_instantiate.restype = c_void_p
    library.rotor_instantiate.argtypes = (c_char_p, c_char_p, c_size_t, type(_hear), c_void_p)
    library.fmi2FreeInstance.restype = None
    for name, types in {
        "SetupExperiment": (instance, c_int, c_double, c_double, c_int, c_double),
        "DoStep": (instance, c_double, c_double, c_int),
        **dict.fromkeys(("SetReal", "SetInteger", "SetBoolean", "SetString"), values),
        **dict.fromkeys(("GetReal", "GetInteger", "GetBoolean", "GetString"), values),
        **dict.fromkeys(("EnterInitializationMode", "ExitInitializationMode"), (instance,)),
        **dict.fromkeys(("Terminate", "FreeInstance"), (instance,)),
        **dict.fromkeys(("GetFMUstate", "SetFMUstate", "FreeFMUstate"), (instance, c_void_p)),
        "SerializedFMUstateSize": (instance, c_void_p, c_void_p),
        "SerializeFMUstate": (instance, c_void_p, c_void_p, c_size_t),
        "DeSerializeFMUstate": (instance, c_void_p, c_size_t, c_void_p),
    }.items():
        getattr(library, f"fmi2{name}").argtypes = types
    return library


# Now, since the FMU's folder may be gone when a run begins.
_LIBRARY = _loaded()
_tables: dict[Path, bytes] = {}
_contents: dict[bytes, bytes] = {}


def _table(resources: str) -> bytes | None:
    """Return the machine's table of an FMU. It is remembered, since a reset makes the instance anew
    and the folder may be gone by then; once, however many folders hold the same."""
    file = Path(resources, TABLE)
    if file.is_file():
        content = file.read_bytes()
        _tables[file] = _contents.setdefault(content, content)
    return _tables.get(file)


def _guarded(method: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a call so that the host gets the reason of a failure."""

    @wraps(method)
    def call(self: "RotorBearing", *arguments: object) -> object:
        try:
            return method(self, *arguments)
        except BaseException as error:  # whatever leaves here unheld would crash the host
            raise self._failed(error) from None

    return call


def _exchange(call: str, kind: str) -> Callable[..., Any]:
    """Return the method that gets variables, or sets them; kind: of `array`."""

    @_guarded
    def exchange(self: "RotorBearing", vrs: list[int], given: Any = None) -> list[Any]:
        """Return the values of variables by their references, each in its unit of the model
        description (FMI 2.0, section 2.1.7); given: as many, which are set. Raises `CallFailed`.
        """
        if not vrs:
            return []
        if given is None or kind == "q":
            given = bytes(8 * len(vrs))
        values, references = array(kind, given), array("i", vrs)
        place = *references.buffer_info(), values.buffer_info()[0]
        self._call(getattr(_LIBRARY, f"fmi2{call}"), *place)
        return values.tolist()

    return exchange


class _Reals:
    """Room for references and values of Reals that a host asks for together, and where it lies."""

    def __init__(self, vrs: list[int]) -> None:
        # the wrapper hands references over as signed numbers
        self._references, self.values = array("i", vrs), array("d", bytes(8 * len(vrs)))
        at, count = self._references.buffer_info()
        self.place = at, count, self.values.buffer_info()[0]
        self.fill = Struct(f"{count}d").pack_into


class RotorBearing(Fmi2Slave):  # type: ignore[misc]  # pythonfmu has no types
    """A machine, driven by its speed or by a torque as its table says.

    One class for both: pythonfmu's wrapper finds direct subclasses of its own only.
    """

    _instance = None

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        settle_exit(self.resources)
        self._heard: list[tuple[int, str]] = []
        self._rooms: dict[tuple[int, ...], _Reals] = {}
        self._is_kept = False  # whether the host has the state from which a step begins
        self._table = _table(self.resources)
        if self._table is None:  # pythonfmu is making the FMU, which gets its table afterwards;
            return  # in one that has lost it, every call fails
        if isinstance(_LIBRARY, str):
            raise CallFailed(self._print(_LIBRARY))
        listener = _hear, id(self._heard)
        name = self.instance_name.encode()
        self._instance = _LIBRARY.rotor_instantiate(name, self._table, len(self._table), *listener)
        if not self._instance:
            raise CallFailed(self._heard[-1][1] if self._heard else "out of memory")

    def __del__(self) -> None:
        """The wrapper has dropped the instance."""
        if self._instance:
            _LIBRARY.fmi2FreeInstance(self._instance)

    def _call(self, function: Callable[..., int], *arguments: object) -> None:
        """Let the library carry out a call."""
        if function(self._instance, *arguments) or self._heard:
            self._log()

    def _log(self, worst: int = _WARNING) -> None:
        """Hand over the library's messages of a call; raises `CallFailed` if it failed, its status
        being above `worst`."""
        if not self._instance:
            raise CallFailed(self._print(f"{Path(self.resources, TABLE)}: cannot be read"))
        received = self._heard[:]
        self._heard.clear()
        if not received or received[-1][0] > worst:
            raise CallFailed(received[-1][1] if received else "internal error")
        for level, sentence in received:
            self.log(sentence, Fmi2Status(level))

    def _failed(self, error: BaseException) -> CallFailed:
        """Return the exception for an error, a single sentence."""
        sentence = self._sentence(error)
        self._heard.clear()
        held(self)
        return CallFailed(sentence)

    def _sentence(self, error: BaseException) -> str:
        """Return the sentence for the host; it is printed here unless the library has printed
        it."""
        if isinstance(error, CallFailed):
            return str(error)
        if isinstance(error, KeyboardInterrupt):
            return self._print(INTERRUPTED)
        if isinstance(error, SystemError | UnicodeDecodeError):  # left pending by the wrapper
            return self._print("setString: a value is not UTF-8 text")
        return self._print(f"internal error, {type(error).__name__}: {error}")

    def _print(self, sentence: str) -> str:
        """Print an error, since hosts drop messages unless logging was switched on; returns it as
        their loggers read it."""
        plain = in_one_line(sentence)
        with suppress(OSError, ValueError):  # a host may have closed it, or have none
            print(f"{self.instance_name}: error: {plain}", file=sys.stderr, flush=True)
        return escaped(plain)

    # --- life of an instance -----------------------------------------------------------------

    @_guarded
    def setup_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Take the start and the stop time [s] and the relative tolerance [1]."""
        has_stop, has_tolerance = stop_time is not None, tolerance is not None
        given = has_tolerance, tolerance or 0.0, start_time, has_stop, stop_time or 0.0
        self._call(_LIBRARY.fmi2SetupExperiment, *given)

    @_guarded
    def enter_initialization_mode(self) -> None:
        """Begin the initialization."""
        self._call(_LIBRARY.fmi2EnterInitializationMode)

    @_guarded
    def exit_initialization_mode(self) -> None:
        """End the initialization."""
        self._call(_LIBRARY.fmi2ExitInitializationMode)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Advance from current_time [s] over step_size [s]; False where the step has ended early.

        What the wrapper makes of False is fmi2Discard, but with the time at which the step began,
        and a wish to end, so that FMPy returns what it has as if it were all. So False is returned
        only to a master that has saved the state and can repeat the step; for any other it is an
        error.
        """
        try:
            status = _LIBRARY.fmi2DoStep(self._instance, current_time, step_size, 0)
            if status or self._heard:
                self._log(_DISCARD if self._is_kept else _WARNING)
            if status == _DISCARD:
                return False
            self._is_kept = False
            return True
        except BaseException as error:
            raise self._failed(error) from None

    @_guarded
    def terminate(self) -> None:
        """End the simulation."""
        self._call(_LIBRARY.fmi2Terminate)

    # --- state -------------------------------------------------------------------------------

    @_guarded
    def _get_fmu_state(self) -> bytes:
        state, size = c_void_p(), c_size_t()
        self._call(_LIBRARY.fmi2GetFMUstate, byref(state))
        try:
            self._call(_LIBRARY.fmi2SerializedFMUstateSize, state, byref(size))
            content = ctypes.create_string_buffer(size.value)
            self._call(_LIBRARY.fmi2SerializeFMUstate, state, content, size)
        finally:
            _LIBRARY.fmi2FreeFMUstate(self._instance, byref(state))
        self._is_kept = True
        return content.raw

    @HeldFromLookUp
    @_guarded
    def _set_fmu_state(self, content: bytes) -> None:
        state = c_void_p()
        self._call(_LIBRARY.fmi2DeSerializeFMUstate, content, len(content), byref(state))
        try:
            self._call(_LIBRARY.fmi2SetFMUstate, state)
        finally:
            _LIBRARY.fmi2FreeFMUstate(self._instance, byref(state))
        self._is_kept = True

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        # checked when it is set: here the host could not be informed
        return state

    # --- values ------------------------------------------------------------------------------

    def _reals(self, vrs: list[int]) -> _Reals:
        """Return the room for some Reals, made once: masters ask for the same at every point."""
        if len(self._rooms) == _MOST_ROOMS:
            self._rooms.clear()
        room = self._rooms[tuple(vrs)] = _Reals(vrs)
        return room

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return the values of Real variables."""
        try:
            room = self._rooms.get(tuple(vrs)) or self._reals(vrs)
            if _LIBRARY.fmi2GetReal(self._instance, *room.place) or self._heard:
                self._log()
            return room.values.tolist()
        except BaseException as error:
            raise self._failed(error) from None

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real variables."""
        try:
            room = self._rooms.get(tuple(vrs)) or self._reals(vrs)
            room.fill(room.values, 0, *values)
            if _LIBRARY.fmi2SetReal(self._instance, *room.place) or self._heard:
                self._log()
        except BaseException as error:
            raise self._failed(error) from None

    # there are no String variables: the library refuses them, whatever their values
    get_integer, set_integer = _exchange("GetInteger", "i"), _exchange("SetInteger", "i")
    get_boolean, set_boolean = _exchange("GetBoolean", "i"), _exchange("SetBoolean", "i")
    get_string, set_string = _exchange("GetString", "q"), _exchange("SetString", "q")
