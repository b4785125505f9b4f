"""What is read from a solved flow."""
