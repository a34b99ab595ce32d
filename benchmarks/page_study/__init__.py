"""How quickly the page comes and moves, in a real browser."""
