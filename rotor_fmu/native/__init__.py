"""The FMU that needs no Python: the compiled kernels in one library a platform, and a C skin."""
