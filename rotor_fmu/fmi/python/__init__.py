"""What the FMU in Python carries: the skin that pythonfmu calls, and the script that imports it."""
