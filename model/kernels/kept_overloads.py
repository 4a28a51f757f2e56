"""numba's hook for code that is kept: what `Dispatcher._cache` is asked for and given.

numba's own keeper (`njit(cache=True)`) trusts what it finds, and a damaged file ends every run. The
hook is not part of numba's documented interface, so all that can fail with another numba is caught:
it then costs the kept code alone.
"""

from __future__ import annotations

import hashlib
import pickle
import sys
import threading
from collections.abc import Callable
from types import CodeType

import numba
from llvmlite import binding

from .code_cache import CodeCache, own_source, say_not_kept, say_once

_processor = f"{binding.get_host_cpu_name()} {binding.get_host_cpu_features().flatten()}"
CACHE = CodeCache(f"{sys.version} {numba.__version__} {_processor}")
_nested = threading.local()


def keep(dispatcher) -> None:
    """Let a numba dispatcher's compiled code be kept, and be compiled by one process at a time."""
    if not hasattr(dispatcher, "_cache"):
        say_not_kept(f"numba {numba.__version__} is not known to this version")
        return
    dispatcher._cache = _KeptOverloads(dispatcher.py_func)
    dispatcher.compile = _unlocking(dispatcher.compile)


def is_kept(dispatcher) -> bool:
    """Whether code of a dispatcher's function is kept, of whatever signature."""
    keeper = dispatcher._cache
    return isinstance(keeper, _KeptOverloads) and CACHE.holds(keeper.beginning)


def _unlocking(compile_signature: Callable) -> Callable:
    """`compile_signature`, with the lock given back after the outermost of the compilations that
    lead to each other, also if it fails."""

    def compile_and_unlock(signature):
        """The dispatcher's `compile`, once for each of the compilations."""
        depth = getattr(_nested, "depth", 0)
        _nested.depth = depth + 1
        try:
            return compile_signature(signature)
        finally:
            _nested.depth = depth
            if depth == 0:
                CACHE.unlock()

    return compile_and_unlock


class _KeptOverloads:
    """The methods of numba's `_Cache` for one function."""

    def __init__(self, function: Callable) -> None:
        self._closure = function.__closure__ or ()
        source = own_source(function)
        self._is_enabled = source is not None
        # how the names of this function's files begin; <locals> cannot stand in them
        name = f"{function.__module__}.{function.__qualname__}".replace("<", "").replace(">", "")
        code = _bytecode(function.__code__).encode() + (source or b"")
        self.beginning = f"{name}-{hashlib.sha256(code).hexdigest()[:16]}-"

    @property
    def cache_path(self) -> str | None:
        return str(CACHE.path) if CACHE.path else None

    def load_overload(self, signature, target_context):
        """The kept code for a signature, or None for numba to compile it."""
        if not self._is_enabled:
            return None
        target_context.refresh()
        try:
            name = self._name(signature, target_context.codegen())
            content = CACHE.read(name)
            if content is None:
                content = CACHE.wait_or_lock(name)
            if content is None:
                return None
        except Exception as error:  # of numba's insides, whatever they raise
            say_not_kept(error)
            return None
        try:
            rebuild = numba.core.compiler.CompileResult._rebuild
            return rebuild(target_context, *pickle.loads(content))
        except Exception as error:  # of numba's insides, whatever they raise
            say_once("not used", f"kept code cannot be used, so it is made again: {error!r}")
            CACHE.discard(name)
            return None

    def save_overload(self, signature, result) -> None:
        """Keep what numba compiled."""
        if not self._is_enabled or CACHE.path is None:
            return
        try:
            if result.library.has_dynamic_globals or any(not x.can_cache for x in result.lifted):
                return
            name = self._name(signature, result.library.codegen)
            CACHE.write(name, numba.core.serialize.dumps(result._reduce()))
        except Exception as error:  # of numba's insides, whatever they raise
            say_not_kept(error)

    def enable(self) -> None:
        self._is_enabled = True

    def disable(self) -> None:
        self._is_enabled = False

    def flush(self) -> None:
        CACHE.discard(self.beginning)

    def _name(self, signature, codegen) -> str:
        """Of a file: the function, and a digest of all that its code depends on beside the sources
        and the compiler, which the folder stands for."""
        digest = hashlib.sha256(f"{signature}\0{codegen.magic_tuple()}".encode())
        if self._closure:
            values = tuple(cell.cell_contents for cell in self._closure)
            digest.update(numba.core.serialize.dumps(values))
        return f"{self.beginning}{digest.hexdigest()[:16]}"


def _bytecode(code: CodeType) -> str:
    """A function's code as text that is the same in every process."""
    constants = [_bytecode(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts]
    return repr((code.co_code, code.co_names, code.co_firstlineno, constants))
