"""numba's dispatchers of kernels. Importing this imports numba."""

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import cgutils, types
from numba.extending import intrinsic, typeof_impl

from .cache import private_folder, user_cache, warn_once
from .digest import kernels_digest
from .kernel import Kernel

_HAS_NRT = hasattr(numba.core.cpu.CPUTargetOptions, "_nrt")
# Options of every kernel of a process that compiles them for another use than calling them.
EXTRA: dict[str, bool] = {}
CACHES = True


def dispatcher(
    function: Callable[..., Any], to_cache: bool = False, options: Mapping[str, Any] = {}
) -> Any:
    """Return the `numba.njit` dispatcher of a function, its code cached on disk if `to_cache`."""
    without_counts = {"_nrt": False} if _HAS_NRT else {}
    made = numba.njit(**{**options, **without_counts, **EXTRA})(function)
    folder = cache_folder() if to_cache and CACHES else None
    if folder:
        usual, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(folder)
        try:
            made.enable_caching()
        except RuntimeError:
            pass  # of a function that was typed in, which has no file
        finally:
            numba.config.CACHE_DIR = usual
    return made


@cache
def cache_folder() -> Path | None:
    """Return the folder in which numba caches the code of these kernels; None, which is logged, if
    there can be no such folder. Numba's own check, the time of a file, ignores the kernels that a
    kernel calls."""
    try:
        kernels = private_folder(user_cache()) / "numba"
        return private_folder(private_folder(kernels) / kernels_digest())
    except (OSError, ImportError) as error:
        warn_once("cache", f"compiled code is not cached for the next process: {error}")
        return None


def is_cached(function: Callable[..., Any]) -> bool:
    """Return whether code of a function is cached, for any signature."""
    folder = cache_folder()
    name = f"{function.__module__.rpartition('.')[2]}.{function.__qualname__}"
    return folder is not None and any(folder.rglob(f"{name}-*.nbc"))


@typeof_impl.register(Kernel)
def _type_of(kernel, context):
    """Return the type of a kernel's dispatcher, which stands for the kernel in compiled code."""
    return typeof_impl(kernel.dispatcher, context)


@intrinsic
def array_at(typing_context, block, offset, shape, dtype):
    """Return `block._array` of a block or of its address, without a reference count. Numba's own
    `carray` cannot be compiled without reference counts."""
    array_type = types.Array(dtype.dtype, len(shape), "C")

    def generate(context, builder, signature, arguments):
        """Return the array's record, filled in with its address and extents."""
        from numba.np import arrayobj

        base = arguments[0]
        if isinstance(signature.args[0], types.Array):
            base = context.make_array(signature.args[0])(context, builder, base).data
        array = arrayobj.make_array(array_type)(context, builder)
        itemsize = context.get_constant(types.intp, arrayobj.get_itemsize(context, array_type))
        extents = [
            context.cast(builder, value, kind, types.intp)
            for value, kind in zip(
                cgutils.unpack_tuple(builder, arguments[2]), signature.args[2], strict=True
            )
        ]
        strides = [itemsize]
        for extent in reversed(extents[1:]):
            strides.insert(0, builder.mul(strides[0], extent))
        place = cgutils.pointer_add(builder, base, arguments[1])
        arrayobj.populate_array(
            array,
            data=builder.bitcast(place, array.data.type),
            shape=extents,
            strides=strides,
            itemsize=itemsize,
            meminfo=None,
        )
        return array._getvalue()

    return array_type(block, offset, shape, dtype), generate
