"""Tools for kernels: the compiler and its cache, band matrices, elementary functions."""
