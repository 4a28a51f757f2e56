"""Machine files of rigs that come with the package."""
