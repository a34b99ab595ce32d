import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.motion import VEHICLES, Vehicle, VehicleError, vehicle_from
from core.motion.vehicle import as_record


@pytest.mark.parametrize("name", VEHICLES)
def test_every_class_is_a_vehicle_that_understeers(name: str) -> None:
    c = vehicle_from(name)

    assert c.a2 / c.cornering_stiffness_1 > c.a1 / c.cornering_stiffness_2, "ordinary vehicles are stable at any speed"
    assert 0.2 < c.yaw_inertia / (c.mass * c.a1 * c.a2) < 2.0


def test_a_mapping_changes_its_class() -> None:
    van = vehicle_from({"class": "van", "mass": 3000, "device": [0.5, -0.2, 0.4]})
    assert (van.mass, van.a1, van.device) == (3000.0, VEHICLES["van"].a1, (0.5, -0.2, 0.4))


def test_without_a_class_it_is_a_sedan() -> None:
    assert vehicle_from({}) == VEHICLES["sedan"] == Vehicle()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("tank", "'tank'; there are city_car"),
        ({"weight": 1500}, "'weight' is not known"),
        ({"mass": 0}, "mass must be a positive number, not 0"),
        ({"mass": "heavy"}, "not 'heavy'"),
        ({"a1": float("nan")}, "a1 must be"),
        ({"a1": float("inf")}, "a1 must be"),
        ({"track": True}, "track must be"),
        ({"device": [1.0, 2.0]}, "device must be three numbers"),
        ({"device": [1.0, 2.0, "high"]}, "device must be three numbers"),
    ],
)
def test_what_cannot_be_used_is_named(given: Any, words: str) -> None:
    with pytest.raises(VehicleError, match=words):
        vehicle_from(given)


def test_the_record_holds_every_value() -> None:
    record = as_record(VEHICLES["bus"])[0]
    for item in fields(Vehicle):
        if item.name != "device":
            assert record[item.name] == getattr(VEHICLES["bus"], item.name)
    assert np.isnan(record["device"]).all()


def test_the_table_of_classes_in_the_manual_is_true() -> None:
    page = (Path(__file__).parents[3] / "docs" / "motion.md").read_text(encoding="utf-8")
    names = [item.name for item in fields(Vehicle) if item.name != "device"]
    for name, c in VEHICLES.items():
        (row,) = re.findall(rf"^\| `{name}` \| (.*) \|$", page, re.MULTILINE)
        told = [float(cell) for cell in row.split(" | ")]
        np.testing.assert_allclose(told, [getattr(c, key) for key in names], rtol=6e-3)
