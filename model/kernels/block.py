"""One block of memory for everything that a run reads or writes, described by a table.

A named tuple says of each of its arrays what it holds and how large it is:

    q: Annotated[np.ndarray, complex, "size"]

The sizes are expressions in a few numbers that stand at the head of the block. From these tuples
follow the table (name, type, shape, offset) and `view`, which finds them all in a block: compiled,
from the block or its address alone, or in plain Python.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, get_type_hints

import numpy as np

from .compiled import IS_COMPILED, compiled

ALIGNMENT = 64
_HEADER_TYPE = np.dtype(np.int64)


class Field(NamedTuple):
    """An array of the block: its path (`motion.q`), type, and extents as expressions in sizes."""

    path: str
    dtype: np.dtype
    extents: tuple[str, ...]

    def shape(self, sizes: Mapping[str, int]) -> tuple[int, ...]:
        """Its shape for these sizes."""
        return tuple(eval(extent, {}, dict(sizes)) for extent in self.extents)


@dataclass(frozen=True)
class Group:
    """A named tuple of the block: its name there, its type, and what stands for members that are
    tuples of arrays themselves (types and extents of each)."""

    name: str
    kind: type
    tuples: Mapping[str, Sequence[tuple[np.dtype, tuple[str, ...]]]]

    def members(self) -> list[tuple[str, list[Field]]]:
        """Each member with its arrays: one, or those of its tuple."""
        members = []
        for name, hint in get_type_hints(self.kind, include_extras=True).items():
            path = f"{self.name}.{name}"
            if name in self.tuples:
                entries = self.tuples[name]
                fields = [Field(f"{path}[{i}]", t, e) for i, (t, e) in enumerate(entries)]
            else:
                dtype, *extents = hint.__metadata__
                fields = [Field(path, np.dtype(dtype), tuple(extents))]
            members.append((name, fields))
        return members


class Layout:
    """The table of a block: groups one after another, sizes at the head.

    run: the named tuple of all groups, in their order; size_names: of the numbers at the head.
    """

    def __init__(self, run: type, groups: Sequence[Group], size_names: Sequence[str]) -> None:
        self.run = run
        self.groups = tuple(groups)
        self.size_names = tuple(size_names)
        self.fields = [f for group in groups for _, fields in group.members() for f in fields]
        self._slot = {f.path: 1 + len(size_names) + i for i, f in enumerate(self.fields)}
        self.header_length = 1 + len(size_names) + len(self.fields)
        self.view: Callable[[Any], Any] = self._view(IS_COMPILED)
        self.look: Callable[[np.ndarray], Any] = self._view(False)

    def offsets(self, sizes: Mapping[str, int]) -> dict[str, int]:
        """Where each array begins [bytes], and under "" where the block ends."""
        at = _padded(self.header_length * _HEADER_TYPE.itemsize)
        where = {}
        for field in self.fields:
            where[field.path] = at
            at += _padded(int(np.prod(field.shape(sizes))) * field.dtype.itemsize)
        return where | {"": at}

    def new(self, sizes: Mapping[str, int]) -> np.ndarray:
        """A block of zeros with its head filled in, dtype uint8."""
        where = self.offsets(sizes)
        raw = np.zeros(where[""] + ALIGNMENT, dtype=np.uint8)
        start = -raw.ctypes.data % ALIGNMENT
        block = raw[start : start + where[""]]
        header = block[: self.header_length * _HEADER_TYPE.itemsize].view(_HEADER_TYPE)
        header[0] = where[""]
        header[1 : 1 + len(self.size_names)] = [sizes[name] for name in self.size_names]
        header[1 + len(self.size_names) :] = [where[field.path] for field in self.fields]
        return block

    def extent(self, block: np.ndarray, group: str) -> slice:
        """Which bytes of the block a group takes."""
        header = block[: self.header_length * _HEADER_TYPE.itemsize].view(_HEADER_TYPE)
        names = [g.name for g in self.groups]
        last = names.index(group) + 1

        def begin(of: str) -> int:
            first = next(f.path for f in self.fields if f.path.startswith(f"{of}."))
            return int(header[self._slot[first]])

        return slice(begin(group), begin(names[last]) if last < len(names) else int(header[0]))

    def _view(self, is_compiled: bool) -> Callable[[Any], Any]:
        """The function that finds all groups in a block, from source that the table spells."""
        scope: dict[str, Any] = {
            "at": _compiled_array if is_compiled else _array,
            "header_type": _HEADER_TYPE,
            "run": self.run,
        }
        lines = [f"    header = at(block, 0, ({self.header_length},), header_type)"]
        lines += [f"    {name} = header[{i}]" for i, name in enumerate(self.size_names, 1)]

        def array(field: Field) -> str:
            kind = f"type_{self._slot[field.path]}"
            scope[kind] = field.dtype
            shape = "".join(f"{extent}, " for extent in field.extents)
            return f"at(block, header[{self._slot[field.path]}], ({shape}), {kind})"

        for group in self.groups:
            scope[f"kind_{group.name}"] = group.kind
            arguments = []
            for name, fields in group.members():
                spelled = [array(field) for field in fields]
                is_tuple = name in group.tuples
                arguments.append(f"({', '.join(spelled)},)" if is_tuple else spelled[0])
            joined = ",\n        ".join(arguments)
            lines.append(f"    {group.name} = kind_{group.name}(\n        {joined},\n    )")
        lines.append(f"    return run({', '.join(group.name for group in self.groups)})")
        exec("def view(block):\n" + "\n".join(lines), scope)
        view: Callable[[Any], Any] = scope["view"]
        return compiled(view, to_keep=False) if is_compiled else view


def _padded(size: int) -> int:
    return max(1, -(-size // ALIGNMENT)) * ALIGNMENT


def _array(block, offset, shape, dtype):
    """The array of this shape and type at an offset [bytes] in a block."""
    size = int(np.prod(shape)) * dtype.itemsize
    found = block[offset : offset + size].view(dtype).reshape(shape)
    return found.view(np.recarray) if dtype.names else found


if IS_COMPILED:
    from numba.core import cgutils, types
    from numba.extending import intrinsic

    @intrinsic
    def _compiled_array(typing_context, block, offset, shape, dtype):
        """`_array` of a block or of its address, without a reference count: numba's own `carray`
        is a function that returns an array, which it does not compile without them."""
        array_type = types.Array(dtype.dtype, len(shape), "C")

        def generate(context, builder, signature, arguments):
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
