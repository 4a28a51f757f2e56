"""Data in the memory of a WebAssembly component, behind what its linker laid out there.

The binary formats are those of the WebAssembly core specification 2.0, section 5, and of the
component model's `Binary.md`: a head of eight bytes, then sections of an identifier, a size and a
content.
"""

from collections.abc import Iterator

_HEAD = 8
_PAGE = 65536
# Sections of a component and of a module.
_CORE_MODULE = 1
_MEMORY, _DATA, _DATA_COUNT = 5, 11, 12
_CONSTANT, _END = 0x41, 0x0B  # i32.const and the end of an expression


def with_data(component: bytes, data: bytes) -> bytes:
    """Return a component in whose module with a memory these bytes follow what the memory begins
    with, the memory as much larger as they take."""
    result = component[:_HEAD]
    for kind, content in _sections(component):
        is_owner = kind == _CORE_MODULE and any(k == _MEMORY for k, _ in _sections(content))
        result += _section(kind, _extended(content, data) if is_owner else content)
    return result


def _extended(module: bytes, data: bytes) -> bytes:
    parts = dict(_sections(module))
    flags = parts[_MEMORY][1]
    pages, after = _unsigned(parts[_MEMORY], 2)
    more = -(-len(data) // _PAGE)
    limits = _leb(1) + bytes([flags]) + _leb(pages + more) + parts[_MEMORY][after:]
    count, first = _unsigned(parts[_DATA], 0)
    segment = bytes([0, _CONSTANT]) + _signed_leb(pages * _PAGE) + bytes([_END])
    segment += _leb(len(data)) + data
    changed = {
        _MEMORY: limits,
        _DATA: _leb(count + 1) + parts[_DATA][first:] + segment,
        _DATA_COUNT: _leb(count + 1),
    }
    sections = (_section(kind, changed.get(kind, of)) for kind, of in _sections(module))
    return module[:_HEAD] + b"".join(sections)


def _sections(binary: bytes) -> Iterator[tuple[int, bytes]]:
    """The kinds and contents of the sections of a module or a component."""
    at = _HEAD
    while at < len(binary):
        size, begin = _unsigned(binary, at + 1)
        yield binary[at], binary[begin : begin + size]
        at = begin + size


def _section(kind: int, content: bytes) -> bytes:
    return bytes([kind]) + _leb(len(content)) + content


def _unsigned(binary: bytes, at: int) -> tuple[int, int]:
    """An integer in LEB128, and the place behind it."""
    value = shift = 0
    while True:
        byte = binary[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


def _leb(value: int) -> bytes:
    result = b""
    while value > 0x7F:
        result += bytes([value & 0x7F | 0x80])
        value >>= 7
    return result + bytes([value])


def _signed_leb(value: int) -> bytes:
    """A positive integer in signed LEB128, whose last byte leaves the sign's bit at zero."""
    result = _leb(value)
    return result if result[-1] < 0x40 else result[:-1] + bytes([result[-1] | 0x80, 0])
