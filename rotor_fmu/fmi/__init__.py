"""An FMU of a machine: its variables, its description, the table that its instance reads, and the
instance in C with its skins."""
