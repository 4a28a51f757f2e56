"""One block of memory for everything that a run reads or writes, described by a table.

A named tuple declares type and extents of each of its arrays:

    q: Annotated[np.ndarray, complex, "size"]

or, in a list, of each array of a tuple. The extents are expressions in a few sizes, which stand at
the head of the block. From these tuples follow the table (name, type, shape, offset) and `view`,
which returns all arrays of a block: compiled, from the block or its address alone, or in plain
Python.
"""

import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple, get_type_hints

import numpy as np

from .jit import IS_COMPILED, OPTIONS
from .kernel import Kernel

ALIGNMENT = 64
_HEADER_TYPE = np.dtype(np.int64)


class Field(NamedTuple):
    """An array of the block: its path (`motion.q`), type, and extents as expressions in sizes."""

    path: str
    dtype: np.dtype
    extents: tuple[str, ...]


class Member(NamedTuple):
    """A member of a named tuple of the block: one array, or a tuple of arrays."""

    fields: tuple[Field, ...]
    is_tuple: bool


@cache
def members(kind: type, name: str) -> tuple[Member, ...]:
    """Return the members of a named tuple, which has this name in the block."""
    result = []
    for member, hint in get_type_hints(kind, include_extras=True).items():
        path, (dtype, *extents) = f"{name}.{member}", hint.__metadata__
        if isinstance(dtype, list):
            arrays = tuple(Field(f"{path}[{i}]", *each) for i, each in enumerate(dtype))
            result.append(Member(arrays, True))
        else:
            result.append(Member((Field(path, np.dtype(dtype), tuple(extents)),), False))
    return tuple(result)


def sizes_of(group: tuple) -> dict[str, int]:
    """Return the extents of the arrays of a named tuple, the names of sizes among them."""
    sizes: dict[str, int] = {}
    for value, member in zip(group, members(type(group), ""), strict=True):
        arrays = value if member.is_tuple else (value,)
        for array, field in zip(arrays, member.fields, strict=True):
            sizes |= zip(field.extents, array.shape, strict=True)
    return sizes


class Layout:
    """The table of a block: the named tuples of `run`, one after another, sizes at the head."""

    def __init__(self, run: type) -> None:
        self.run = run
        self.groups = get_type_hints(run)
        self._members = {name: members(kind, name) for name, kind in self.groups.items()}
        self.fields = [f for of in self._members.values() for member in of for f in member.fields]
        extents = " ".join(extent for field in self.fields for extent in field.extents)
        self.size_names = tuple(dict.fromkeys(re.findall(r"[a-z]\w*", extents)))
        self._slot = {f.path: 1 + len(self.size_names) + i for i, f in enumerate(self.fields)}
        self.header_length = 1 + len(self.size_names) + len(self.fields)
        counts = ", ".join(" * ".join(f"({e})" for e in f.extents) or "1" for f in self.fields)
        names = ", ".join(self.size_names)
        self._counts: Callable[..., list[int]] = eval(f"lambda {names}: [{counts}]")
        self.view_in_python: Callable[[np.ndarray], Any] = self._view(_array)
        self.view: Callable[[Any], Any] = (
            Kernel(self.view_in_python, self._made) if IS_COMPILED else self.view_in_python
        )

    def offsets(self, sizes: Mapping[str, int]) -> dict[str, int]:
        """Return the offset of each array, and under "" the end of the block [bytes]."""
        at = _padded(self.header_length * _HEADER_TYPE.itemsize)
        where = {}
        for field, count in zip(
            self.fields, self._counts(*(sizes[name] for name in self.size_names)), strict=True
        ):
            where[field.path] = at
            at += _padded(count * field.dtype.itemsize)
        return where | {"": at}

    def new(self, sizes: Mapping[str, int]) -> np.ndarray:
        """Return a block of zeros with its head filled in, dtype uint8."""
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
        """Return the range of bytes of a group in a block."""
        header = block[: self.header_length * _HEADER_TYPE.itemsize].view(_HEADER_TYPE)
        names = list(self.groups)
        last = names.index(group) + 1

        def begin(of: str) -> int:
            first = next(f.path for f in self.fields if f.path.startswith(f"{of}."))
            return int(header[self._slot[first]])

        return slice(begin(group), begin(names[last]) if last < len(names) else int(header[0]))

    def _made(self) -> Any:
        from .dispatching import array_at, dispatcher

        return dispatcher(self._view(array_at), options=OPTIONS)

    def _view(self, at: Callable[..., Any]) -> Callable[[Any], Any]:
        """Return the function that returns all groups of a block, from generated source; at: the
        function that returns an array."""
        scope: dict[str, Any] = {"at": at, "header_type": _HEADER_TYPE, "run": self.run}
        lines = [f"    header = at(block, 0, ({self.header_length},), header_type)"]
        lines += [f"    {name} = header[{i}]" for i, name in enumerate(self.size_names, 1)]

        def array(field: Field) -> str:
            kind = f"type_{self._slot[field.path]}"
            scope[kind] = field.dtype
            shape = "".join(f"{extent}, " for extent in field.extents)
            return f"at(block, header[{self._slot[field.path]}], ({shape}), {kind})"

        for group, kind in self.groups.items():
            scope[f"kind_{group}"] = kind
            arguments = []
            for member in self._members[group]:
                spelled = ", ".join(map(array, member.fields))
                arguments.append(f"({spelled},)" if member.is_tuple else spelled)
            joined = ",\n        ".join(arguments)
            lines.append(f"    {group} = kind_{group}(\n        {joined},\n    )")
        lines.append(f"    return run({', '.join(self.groups)})")
        exec("def view(block):\n" + "\n".join(lines), scope)
        view: Callable[[Any], Any] = scope["view"]
        return view


def _padded(size: int) -> int:
    return max(1, -(-size // ALIGNMENT)) * ALIGNMENT


def _array(block, offset, shape, dtype):
    """Return the array of this shape and type at an offset [bytes] in a block."""
    result = np.ndarray(shape, dtype, block, offset)
    return result.view(np.recarray) if dtype.names else result
