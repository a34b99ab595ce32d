"""Every numba function of the attitude filters; imports nothing of the project: numba's cache watches one file."""
