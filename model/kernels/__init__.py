"""What kernels are made with: the compiler and its cache, band matrices."""
