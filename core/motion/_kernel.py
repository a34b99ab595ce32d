"""Every numba function of the motion; imports nothing of the project, so that numba's cache is never stale."""
