"""The manager's desk of `livella demo`: alerts that somebody has dealt with before the visitor comes."""

from threading import Event
from typing import Any, NamedTuple

from api.commands.device import RefusedError, Service, UnavailableError

LOOK_EVERY = 2.0
"""s"""


class Note(NamedTuple):
    """What is done about an alert as soon as it is there."""

    device_id: str
    kind: str
    action: str
    """acknowledge, resolve"""
    text: str


NOTES = (
    Note("van-101", "gps_lost", "acknowledge", "Stands in the underground car park until Monday."),
    Note("camper-401", "device_silent", "resolve", "Laid up for the winter, the battery is disconnected."),
)


def keep_desk(office: Service, end: Event) -> None:
    """Act on each of the alerts once; `office` is asked with the key of a manager or above."""
    todo = list(NOTES)
    while todo and not end.wait(LOOK_EVERY):
        try:
            todo = [note for note in todo if not _act(office, note)]
        except (RefusedError, UnavailableError):
            continue  # somebody was quicker, or the service is ending


def _act(office: Service, note: Note) -> bool:
    """Act if the alert is there; tell whether it was."""
    wanted: dict[str, Any] = {"device_id": note.device_id, "kind": note.kind, "state": "open"}
    for alert in office.request("GET", "alerts", params=wanted)["items"]:
        office.request("POST", f"alerts/{alert['id']}/{note.action}", json={"note": note.text})
        return True
    return False
