"""What is installed, built and cached, and the structure of the packages."""
