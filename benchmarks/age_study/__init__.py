"""What a large fleet and a long past cost."""
