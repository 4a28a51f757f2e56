"""The solver library: kernels -> LLVM IR -> objects -> one library a platform."""
