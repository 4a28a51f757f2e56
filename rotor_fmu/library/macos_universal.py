"""One macOS library for both of its processors: hosts of FMI 2.0 know one folder for macOS."""

import struct

_MAGIC = 0xCAFEBABE
# Processor, its kind, and the alignment of its part as a power of two.
_X86_64, _ARM64 = (0x01000007, 3, 14), (0x0100000C, 0, 14)


def universal(x86_64: bytes, arm64: bytes) -> bytes:
    """Return the file that holds both libraries (Mach-O's `fat_header`, big-endian)."""
    parts = ((_X86_64, x86_64), (_ARM64, arm64))
    head = struct.pack(">II", _MAGIC, len(parts))
    body = b""
    begin = 1 << _X86_64[2]
    for (processor, kind, alignment), data in parts:
        body += bytes(-len(body) % (1 << alignment))
        head += struct.pack(">5I", processor, kind, begin + len(body), len(data), alignment)
        body += data
    return head + bytes(begin - len(head)) + body
