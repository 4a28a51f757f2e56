"""A machine in matrices: shaft elements, assembly, reduction, entries of the energy ledger."""
