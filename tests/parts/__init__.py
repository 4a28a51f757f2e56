"""Parts of machines."""
