"""Motion of a vehicle whose device's mounting is known: velocity, sideslip, trajectory, events."""
