"""Every numba function of the attitude filters; imports nothing of the project, so that numba's cache is never stale."""
