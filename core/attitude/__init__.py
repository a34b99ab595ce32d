"""Attitude of a sensor from its own readings: filters of angular rate, specific force and magnetic field."""

from core.attitude.characterise import AllanDeviation, CharacteriseError, Characteristics, characterise
from core.attitude.filters import FILTERS, Attitudes, Filter, State, has_compass, initial_state
from core.attitude.params import DEFAULT, Parameters

__all__ = [
    "DEFAULT",
    "FILTERS",
    "AllanDeviation",
    "Attitudes",
    "CharacteriseError",
    "Characteristics",
    "Filter",
    "Parameters",
    "State",
    "characterise",
    "has_compass",
    "initial_state",
]
