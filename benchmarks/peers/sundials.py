"""SUNDIALS' CVODE with nothing of Python in its loop.

scikit-sundae brings SUNDIALS' libraries, but calls right-hand side and Jacobian through Python,
which costs as much as CVODE's own work on a machine of this size. Here the same libraries get
compiled callbacks, and tell the number of steps, which scikit-sundae does not.
"""

import ctypes
import importlib.metadata
from collections.abc import Callable
from ctypes import POINTER, byref, c_double, c_int, c_int64, c_long, c_void_p
from dataclasses import dataclass
from functools import cache
from typing import Any

import numba
import numpy as np
from numba import carray, types

from ..equations import Coefficients, Equations, jacobian, slope

_BDF, _NORMAL = 2, 1
_NUMBERS = POINTER(c_double)
_NAMES = ("core", "nvecserial", "sunmatrixdense", "sunlinsoldense", "cvode")


class SundialsError(RuntimeError):
    """CVODE gave up; says with which of its flags."""


@dataclass(frozen=True)
class Solution:
    """States at the times asked for, shape (times, 2N); CVODE's steps and evaluations."""

    states: np.ndarray
    steps: int
    evaluations: int
    jacobians: int


@cache
def _libraries() -> dict[str, ctypes.CDLL]:
    """SUNDIALS' shared libraries as the installed scikit-sundae has them."""
    result = {}
    try:
        files = importlib.metadata.files("scikit-sundae") or ()
    except importlib.metadata.PackageNotFoundError as error:
        raise ImportError("not installed (pip install scikit-sundae)") from error
    for file in files:
        for name in _NAMES:
            if file.name.startswith(f"libsundials_{name}-"):
                result[name] = str(file.locate())
    missing = [name for name in _NAMES if name not in result]
    if missing:
        raise ImportError(f"this scikit-sundae brings no library of SUNDIALS' {missing[0]}")
    return {name: ctypes.CDLL(result[name], ctypes.RTLD_GLOBAL) for name in _NAMES}


def load() -> None:
    """Load the libraries and compile the callbacks; raises `ImportError` or `OSError`."""
    _callbacks()


def _function(library: str, name: str, result: type | None, *arguments: type) -> Callable:
    function = getattr(_libraries()[library], name)
    function.restype, function.argtypes = result, arguments
    return function


def _packed(coefficients: Coefficients) -> np.ndarray:
    """All coefficients in one row of numbers: N / 2, bearings, then array after array."""
    half, bearings = coefficients.gyroscopic.shape[0], len(coefficients.bearing)
    arrays = [np.asarray(array, dtype=float).ravel() for array in coefficients]
    return np.concatenate([[half, bearings], *arrays])


@cache
def _callbacks() -> tuple[Any, Any]:
    """Right-hand side and Jacobian as the C functions that CVODE calls."""
    vector = _function("core", "N_VGetArrayPointer", _NUMBERS, c_void_p)
    entries = _function("sunmatrixdense", "SUNDenseMatrix_Data", _NUMBERS, c_void_p)

    @numba.njit
    def unpacked(user):
        head = carray(user, 2)
        n, b = int(head[0]), int(head[1])
        counts = (2 * n * n, 2 * n * n, n * n, 2 * n, 4 * n, b * n, 2 * b, 7 * b, 3)
        ends = np.cumsum(np.array(counts)) + 2
        a = carray(user, ends[8])
        return Coefficients(
            a[2 : ends[0]].reshape(2, n, n),
            a[ends[0] : ends[1]].reshape(2, n, n),
            a[ends[1] : ends[2]].reshape(n, n),
            a[ends[2] : ends[3]],
            a[ends[3] : ends[4]].reshape(2 * n, 2),
            a[ends[4] : ends[5]].reshape(b, n),
            a[ends[5] : ends[6]].reshape(b, 2).astype(np.int64),
            a[ends[6] : ends[7]].reshape(b, 7),
            a[ends[7] : ends[8]],
        )

    pointer, numbers = types.voidptr, types.CPointer(types.float64)

    @numba.cfunc(types.int32(types.float64, pointer, pointer, numbers))
    def right_hand_side(t, y, y_dot, user):
        size = 4 * int(carray(user, 1)[0])
        state = carray(vector(y), size)
        slope(t, state, carray(vector(y_dot), size), unpacked(user))
        return 0

    @numba.cfunc(
        types.int32(types.float64, pointer, pointer, pointer, numbers, pointer, pointer, pointer)
    )
    def jacobian_matrix(t, y, y_dot, matrix, user, one, two, three):
        size = 4 * int(carray(user, 1)[0])
        state = carray(vector(y), size)
        by_columns = carray(entries(matrix), (size, size)).T
        jacobian(t, state, by_columns, unpacked(user))
        return 0

    return right_hand_side, jacobian_matrix


def solve(
    machine: Equations,
    start: np.ndarray,
    times: np.ndarray,
    rtol: float,
    atol: np.ndarray,
    max_order: int,
) -> Solution:
    """Integrate from times[0] by the BDF of CVODE with its direct dense solver.

    start: state (q, v), shape (2N,); times: ascending, shape (times,) [s]; atol: shape (2N,).
    Raises `ImportError` without scikit-sundae's libraries, and `SundialsError`.
    """
    size = len(start)
    data = _packed(machine.coefficients)
    right_hand_side, jacobian_matrix = _callbacks()
    context, memory, reached = c_void_p(), c_void_p(), c_double()

    def check(flag: int) -> None:
        if flag < 0:
            raise SundialsError(f"CVODE stopped at t = {reached.value:.6g} s with flag {flag}")

    def vector(values: np.ndarray) -> tuple[c_void_p, np.ndarray]:
        handle = c_void_p(
            _function("nvecserial", "N_VNew_Serial", c_void_p, c_int64, c_void_p)(size, context)
        )
        numbers = _function("core", "N_VGetArrayPointer", _NUMBERS, c_void_p)(handle)
        shown = np.ctypeslib.as_array(numbers, (size,))
        shown[:] = values
        return handle, shown

    def call(name: str, *arguments: object) -> None:
        types_ = tuple(type(a) if hasattr(a, "value") else c_void_p for a in arguments)
        check(_function("cvode", name, c_int, *types_)(*arguments))

    check(_function("core", "SUNContext_Create", c_int, c_int, c_void_p)(0, byref(context)))
    memory.value = _function("cvode", "CVodeCreate", c_void_p, c_int, c_void_p)(_BDF, context)
    y, state = vector(start)
    tolerances, _ = vector(atol)
    matrix = c_void_p(
        _function("sunmatrixdense", "SUNDenseMatrix", c_void_p, c_int64, c_int64, c_void_p)(
            size, size, context
        )
    )
    solver = c_void_p(
        _function("sunlinsoldense", "SUNLinSol_Dense", c_void_p, c_void_p, c_void_p, c_void_p)(
            y, matrix, context
        )
    )
    try:
        call("CVodeInit", memory, c_void_p(right_hand_side.address), c_double(times[0]), y)
        call("CVodeSVtolerances", memory, c_double(rtol), tolerances)
        call("CVodeSetUserData", memory, c_void_p(data.ctypes.data))
        call("CVodeSetLinearSolver", memory, solver, matrix)
        call("CVodeSetJacFn", memory, c_void_p(jacobian_matrix.address))
        call("CVodeSetMaxOrd", memory, c_int(max_order))
        call("CVodeSetMaxNumSteps", memory, c_long(1_000_000_000))
        call("CVodeSetStopTime", memory, c_double(times[-1]))
        states = np.empty((len(times), size))
        states[0] = start
        march = _function("cvode", "CVode", c_int, c_void_p, c_double, c_void_p, c_void_p, c_int)
        for i, t in enumerate(times[1:], 1):
            check(march(memory, t, y, byref(reached), _NORMAL))
            states[i] = state
        counts = []
        for name in ("CVodeGetNumSteps", "CVodeGetNumRhsEvals", "CVodeGetNumJacEvals"):
            count = c_long()
            call(name, memory, byref(count))
            counts.append(count.value)
        return Solution(states, *counts)
    finally:
        _function("cvode", "CVodeFree", None, c_void_p)(byref(memory))
        _function("core", "SUNLinSolFree", c_int, c_void_p)(solver)
        _function("core", "SUNMatDestroy", None, c_void_p)(matrix)
        for handle in (y, tolerances):
            _function("core", "N_VDestroy", None, c_void_p)(handle)
        _function("core", "SUNContext_Free", c_int, c_void_p)(byref(context))
