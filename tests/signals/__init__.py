"""What is recorded and computed from signals."""
