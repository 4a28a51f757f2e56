"""The FMU of a machine: its variables, its description, the table that its instance reads, and the
instance in C with its interfaces for FMI 2.0 and 3.0."""
