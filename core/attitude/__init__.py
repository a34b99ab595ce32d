"""Attitude of a sensor from its own readings: filters of angular rate, specific force and magnetic field."""
