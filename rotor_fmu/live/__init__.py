"""The page on which a machine runs: the solver library as WebAssembly, driven in the browser."""
