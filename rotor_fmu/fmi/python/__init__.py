"""The FMU in Python: the slave that pythonfmu calls, and the script that imports it."""
