"""The FMU in Python: the slave that pythonfmu calls, and the script that imports it."""

CHECKSUMS: dict[str, str] = {}  # SHA-256 of an FMU's libraries by the file's name, in the FMU
