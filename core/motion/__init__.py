"""Motion of a vehicle whose device's mounting is known: velocity, sideslip, trajectory, events.

    motion = reconstruct(VEHICLES["sedan"], q_vs, samples)

`advance` does the same for samples that come in pieces. Frames and units as in `core`.
"""

from core.motion.motion import Motion, Origin
from core.motion.params import DEFAULT, Parameters
from core.motion.reconstruct import advance, reconstruct
from core.motion.state import State, initial_state
from core.motion.static_start import StaticStart, static_start
from core.motion.vehicle import VEHICLES, Vehicle, VehicleError, vehicle_from

__all__ = [
    "DEFAULT",
    "VEHICLES",
    "Motion",
    "Origin",
    "Parameters",
    "State",
    "StaticStart",
    "Vehicle",
    "VehicleError",
    "advance",
    "initial_state",
    "reconstruct",
    "static_start",
    "vehicle_from",
]
