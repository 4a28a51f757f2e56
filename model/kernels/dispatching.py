"""numba's dispatchers of kernels. Importing this imports numba."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numba
from numba.core import cgutils, types
from numba.extending import intrinsic, typeof_impl

from .compiled import Kernel
from .kept_overloads import keep

_HAS_NRT = hasattr(numba.core.cpu.CPUTargetOptions, "_nrt")
# Options of every kernel of a process that compiles them for another use than calling them.
EXTRA: dict[str, bool] = {}


def dispatcher(
    function: Callable[..., Any], to_keep: bool = False, options: Mapping[str, Any] = {}
) -> Any:
    """What `numba.njit` makes of a function, its code kept on disk if `to_keep`."""
    without_counts = {"_nrt": False} if _HAS_NRT else {}
    made = numba.njit(**{**options, **without_counts, **EXTRA})(function)
    if to_keep:
        keep(made)
    return made


@typeof_impl.register(Kernel)
def _type_of(kernel, context):
    """In compiled code a kernel stands for its dispatcher."""
    return typeof_impl(kernel.dispatcher, context)


@intrinsic
def array_at(typing_context, block, offset, shape, dtype):
    """`block._array` of a block or of its address, without a reference count: numba's own `carray`
    is a function that returns an array, which it does not compile without them."""
    array_type = types.Array(dtype.dtype, len(shape), "C")

    def generate(context, builder, signature, arguments):
        """The array's record, filled with where it lies and its extents."""
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
