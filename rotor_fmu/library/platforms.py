"""The platforms that the solver library is made for."""

from dataclasses import dataclass
from datetime import date


@dataclass(frozen=True)
class Platform:
    """A platform: its folder among an FMU's binaries, of FMI 2.0 and of FMI 3.0; what LLVM and what
    zig call it; the processor that every machine of the kind has; how its libraries end; what else
    LLVM may use of the processor."""

    fmi2: str
    fmi3: str
    triple: str
    processor: str
    zig: str
    suffix: str
    features: str = ""

    @property
    def name(self) -> str:
        """Its name for users, that of FMI 2.0."""
        return self.fmi2


# The fields of each in their order. FMI 2.0 names no ARM platforms: those are called as in FMI 3.0,
# the words turned round.
_TABLE = """
linux64         x86_64-linux    x86_64-unknown-linux-gnu    x86-64    x86_64-linux-gnu.2.17   .so
win64           x86_64-windows  x86_64-w64-windows-gnu      x86-64    x86_64-windows-gnu      .dll
darwin64        x86_64-darwin   x86_64-apple-macosx11.0.0   x86-64    x86_64-macos            .dylib
aarch64-linux   aarch64-linux   aarch64-unknown-linux-gnu   generic   aarch64-linux-gnu.2.17  .so
aarch64-darwin  aarch64-darwin  arm64-apple-macosx11.0.0    apple-m1  aarch64-macos           .dylib
"""
PLATFORMS = {row.split()[0]: Platform(*row.split()) for row in _TABLE.strip().splitlines()}


# What a page carries: no platform of an FMU. Its memory has 32-bit addresses.
WASM = Platform("wasm32", "wasm32", "wasm32-unknown-unknown", "generic", "wasm32-wasi", ".wasm")

LIBRARIES = PLATFORMS | {WASM.name: WASM}

# What an FMU of FMI 3.0 carries where it is asked for by name, as the working draft of a layered
# standard has it (modelica/fmi-ls-wasm).
COMPONENT = Platform(
    "wasm32-wasip2", "wasm32-wasip2", WASM.triple, WASM.processor, WASM.zig, WASM.suffix
)
# Of that draft: its day.
DRAFT = date(2026, 7, 8)
