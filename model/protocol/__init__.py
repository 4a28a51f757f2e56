"""What a part of a machine has to say of itself, and what assembly and kernels take of it."""
