"""`rotor-fmu magnetic-bearing`: a compressor coupled with the FMU of its magnetic bearings."""
