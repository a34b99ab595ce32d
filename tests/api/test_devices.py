import pytest
import sqlalchemy as sa

from api.services import paging
from storage import alerts, devices, mounts
from storage.database import Database, WriteSession
from storage.models import metadata
from tests.conftest import Clock
from tests.drives import chunks, remounted
from tests.service import Api, Device


def ids(page: dict[str, list[dict[str, str]]]) -> list[str]:
    return [item["id"] for item in page["items"]]


def test_registering_shows_the_device_and_its_key_once(api: Api, clock: Clock) -> None:
    made = api.post("/devices", {"id": "Box:7_a.b-c", "name": " Truck 7 ", "vehicle": "MAN", "notes": "left"}, 201)
    assert made["device"] == {
        "id": "Box:7_a.b-c",
        "name": "Truck 7",
        "vehicle": "MAN",
        "notes": "left",
        "accelerometer_calibration": None,
        "created_at": "2024-05-06T07:08:09Z",
        "stage": "waiting",
        "progress": 0.0,
        "mount_status": None,
        "open_alerts": 0,
        "last_data_at": None,
        "revision": 0,
        "vehicle_class": None,
    }
    assert api.get("/devices/Box:7_a.b-c") == made["device"]
    assert "key" not in api.get("/devices/Box:7_a.b-c")
    assert Api(api.client, made["key"]).get("/session")["device_id"] == "Box:7_a.b-c"


def test_an_id_is_made_when_none_is_given(api: Api) -> None:
    first, second = (api.post("/devices", {"name": "x"}, 201)["device"]["id"] for _ in range(2))
    assert first != second


def test_an_id_is_taken_only_once(api: Api) -> None:
    device = api.add_device("same")
    problem = api.post("/devices", {"id": "same", "name": "other"}, 409)
    assert problem["type"].endswith("conflict")
    assert api.get("/devices/same")["name"] == "Box same"
    device.installation()


@pytest.mark.parametrize(
    "draft",
    [
        {},
        {"name": ""},
        {"name": "  "},
        {"name": "x" * 129},
        {"name": "x", "id": ""},
        {"name": "x", "id": "a b"},
        {"name": "x", "id": "../a"},
        {"name": "x", "id": "a\n"},
        {"name": "x", "id": "a" * 65},
        {"name": "x", "notes": "n" * 4001},
        {"name": "x", "role": "admin"},
        {"name": "x\x00"},
        [],
    ],
)
def test_a_draft_is_checked(api: Api, draft: object) -> None:
    problem = api.post("/devices", draft, 422)
    assert problem["type"].endswith("invalid-request")
    assert problem["errors"][0]["pointer"].startswith("/body")
    assert api.get("/devices")["items"] == []


def test_editing_changes_only_what_is_given(api: Api) -> None:
    api.post("/devices", {"id": "a", "name": "A", "vehicle": "V", "notes": "N"}, 201)
    edited = api.call("PATCH", "/devices/a", 200, json={"notes": "new"}).json()
    assert (edited["name"], edited["vehicle"], edited["notes"]) == ("A", "V", "new")
    edited = api.call("PATCH", "/devices/a", 200, json={"vehicle": None, "name": "B"}).json()
    assert (edited["name"], edited["vehicle"], edited["notes"]) == ("B", None, "new")
    api.call("PATCH", "/devices/a", 422, json={"name": None})
    api.call("PATCH", "/devices/a", 422, json={"id": "b"})
    assert api.call("PATCH", "/devices/a", 200, json={}).json() == edited
    for missing in ("b", "a%00", "a%0A", "a%20b", "%2e%2e"):
        api.call("PATCH", f"/devices/{missing}", 404, json={"name": "x"})


def test_removing_removes_everything_of_the_device(api: Api, database: Database) -> None:
    api.add_device("other").send_all(chunks()[:2])
    with database.read() as tx:
        before = counts(tx.connection)
    device = api.add_device("gone")
    device.send_all(chunks())
    device.send(chunks()[0], 5, "b", expect=202)
    api.call("DELETE", "/devices/gone", 204)
    with database.read() as tx:
        assert counts(tx.connection) == before
    for method in ("GET", "DELETE"):
        api.call(method, "/devices/gone", 404)
    again = api.add_device("gone")
    assert again.installation()["stage"] == "waiting"


def counts(connection: sa.Connection) -> dict[str, int]:
    tables = [table for table in metadata.sorted_tables if table.name not in {"audit", "events", "meta"}]
    return {t.name: connection.execute(sa.select(sa.func.count()).select_from(t)).scalar_one() for t in tables}


def test_the_list_is_found_page_by_page(api: Api) -> None:
    names = ["b", "B", "a-2", "a", "a10", "Z", "0"]
    for name in names:
        api.add_device(name)
    page = api.get("/devices", params={"limit": 3})
    seen = ids(page)
    api.call("DELETE", f"/devices/{seen[-1]}", 204)  # the one the cursor names
    api.add_device("00")  # before the cursor: not seen any more
    api.add_device("zz")  # after it: seen
    while page["next_cursor"]:
        page = api.get("/devices", params={"limit": 3, "cursor": page["next_cursor"]})
        seen += ids(page)
    assert seen == sorted([*names, "zz"])


def test_the_list_is_filtered(api: Api) -> None:
    api.post("/devices", {"id": "a", "name": "Ärmel", "vehicle": "Van_1", "notes": "100%"}, 201)
    moving = api.add_device("b", vehicle="Van 1")
    moving.send_all(chunks())
    for q, found in {"van": ["a", "b"], "VAN_": ["a"], "0%": ["a"], "%": ["a"], "box b": ["b"], "nothing": []}.items():
        assert ids(api.get("/devices", params={"q": q})) == found, q
    assert ids(api.get("/devices", params={"stage": "confirmed"})) == ["b"]
    assert ids(api.get("/devices", params={"stage": "waiting", "q": "van"})) == ["a"]
    assert ids(api.get("/devices", params={"has_open_alert": True})) == []
    assert ids(api.get("/devices", params={"has_open_alert": False})) == ["a", "b"]


def test_the_list_is_in_the_order_asked_for(api: Api, clock: Clock) -> None:
    """Page by page, also where names are alike, of any script, and as long as they can be."""
    long = "\u0390" * 128  # three times as long without regard to case
    for device_id, name in (("a", "zebra"), ("b", "Ärmel"), ("c", "Zebra"), ("d", "apple"), ("e", long), ("f", long)):
        api.add_device(device_id, name=name)
    for device_id in ("c", "a"):
        clock.advance(60)
        Device(api, device_id, api.post(f"/devices/{device_id}/key")["key"]).send(chunks()[0], 0, expect=200)
    assert by_pages(api, sort="name") == ["d", "a", "c", "b", "e", "f"]
    assert by_pages(api, sort="-name") == ["f", "e", "b", "c", "a", "d"]
    assert by_pages(api, sort="last_data_at") == ["c", "a", "b", "d", "e", "f"]
    assert by_pages(api, sort="-last_data_at") == ["a", "c", "f", "e", "d", "b"]
    assert by_pages(api, sort="-id", q="zebra") == ["c", "a"]
    api.call("PATCH", "/devices/c", 200, json={"name": "aardvark"})
    assert by_pages(api, sort="name")[:2] == ["c", "d"]


def by_pages(api: Api, **query: str) -> list[str]:
    page = api.get("/devices", params=query | {"limit": 1})
    seen = ids(page)
    while page["next_cursor"]:
        page = api.get("/devices", params=query | {"limit": 1, "cursor": page["next_cursor"]})
        seen += ids(page)
    return seen


@pytest.mark.parametrize("sort", ["id", "-id", "-name", "last_data_at"])
def test_a_cursor_belongs_to_its_order(api: Api, sort: str) -> None:
    for device_id in ("a", "b"):
        api.add_device(device_id)
    cursor = api.get("/devices", params={"limit": 1, "sort": "name"})["next_cursor"]
    problem = api.get("/devices", 422, params={"cursor": cursor, "sort": sort})
    assert problem["type"].endswith("invalid-cursor")
    assert "another order" in problem["detail"]
    assert ids(api.get("/devices", params={"cursor": cursor, "sort": "name"})) == ["b"]


WRONG_PLACES = {
    "id": ("", "id", "id a", "size a ", "id a\0 "),
    "last_data_at": ("last_data_at a x", "last_data_at a -1", f"last_data_at a {10**16}"),
}
"""what is in a cursor, by the order it is given with"""


@pytest.mark.parametrize(
    "query",
    [
        *({"limit": 0}, {"limit": 501}, {"stage": "x"}, {"cursor": "§"}, {"cursor": "_w"}, {"q": "x" * 129}),
        *({"q": "\x00"}, {"sort": "stage"}, {"sort": "+id"}, {"alert_kind": "x"}, {"alert_severity": "error"}),
        *({"cursor": paging.encode(place), "sort": sort} for sort, places in WRONG_PLACES.items() for place in places),
    ],
)
def test_a_query_is_checked(api: Api, query: dict[str, object]) -> None:
    assert api.call("GET", "/devices", 422, params=query).json()["status"] == 422


def test_the_summary_counts_stages_and_alerts(api: Api) -> None:
    api.add_device("a")
    api.add_device("b").send_all(chunks())
    summary = api.get("/fleet/summary")
    assert summary["devices"] == 2
    assert summary["stages"] == {"waiting": 1, "aligning": 0, "settling": 0, "verifying": 0, "confirmed": 1}
    assert (summary["open_alerts"], summary["alerts"]) == (0, {})
    assert (summary["silent"], summary["suspect"]) == (0, 0)
    assert summary["severities"] == {"info": 0, "warning": 0, "critical": 0}


def test_devices_are_found_and_counted_by_what_is_the_matter(api: Api, database: Database, clock: Clock) -> None:
    """A device counts once for a severity, and an alert that is over for nothing; a device counts itself alone."""
    raised = {
        "a": {"device_silent": "warning", "gps_lost": "warning"},
        "b": {"device_silent": "critical"},
        "c": {"gps_lost": "info", "device_silent": "resolved"},
        "d": {},
    }
    known = {device_id: api.add_device(device_id) for device_id in raised}
    with database.write() as tx:
        for device_id, kinds in raised.items():
            pk = devices.exists(tx, device_id)
            assert pk is not None
            _raise(tx, pk, kinds, clock)
    summary = api.get("/fleet/summary")
    assert summary["severities"] == {"info": 1, "warning": 1, "critical": 1}
    assert (summary["silent"], summary["open_alerts"]) == (2, 4)
    own = known["a"].api.get("/fleet/summary")
    assert (own["severities"], own["silent"]) == ({"info": 0, "warning": 1, "critical": 0}, 1)
    for filters, found in (
        ({"alert_kind": "device_silent"}, ["a", "b"]),
        ({"alert_severity": "warning"}, ["a"]),
        ({"alert_kind": "gps_lost", "alert_severity": "info"}, ["c"]),
        ({"alert_kind": "device_silent", "alert_severity": "info"}, []),
        ({"alert_kind": "gps_lost", "has_open_alert": "false"}, []),
        ({"alert_kind": "gps_lost", "q": "box c", "stage": "waiting"}, ["c"]),
    ):
        assert by_pages(api, **filters) == found, filters
        assert by_pages(api, **filters, sort="-name") == found[::-1], filters


def _raise(tx: WriteSession, pk: int, kinds: dict[str, str], clock: Clock) -> None:
    for kind, severity in kinds.items():
        shown = severity if severity != "resolved" else "warning"
        number = alerts.raise_(tx, pk, alerts.Finding(kind, shown, "", {}), clock.now)
        if severity == "resolved":
            alerts.resolve(tx, number, "x", None, clock.now)


def test_the_summary_counts_mountings_in_doubt(api: Api, database: Database, clock: Clock) -> None:
    for device_id in ("a", "b"):
        api.add_device(device_id).send_all(chunks())
    with database.write() as tx:
        pk = devices.exists(tx, "b")
        assert pk is not None
        mounts.suspect(tx, pk, clock.now)
    assert api.get("/fleet/summary")["suspect"] == 1
    assert [device["mount_status"] for device in api.get("/devices")["items"]] == ["in_force", "suspect"]


def test_devices_are_listed_by_the_state_of_their_mounting(api: Api) -> None:
    story = remounted()
    for name, number in (("held", story.confirmed), ("moved", story.moved), ("mended", story.confirmed_anew)):
        api.add_device(name).send_all(story.chunks[: number + 1])
    api.add_device("new")

    def listed(status: str, **more: str) -> list[str]:
        return ids(api.get("/devices", params={"mount_status": status, **more}))

    assert listed("suspect") == ["moved"]
    assert api.get("/fleet/summary")["suspect"] == 1
    assert listed("in_force") == ["held", "mended"]
    assert listed("in_force", sort="-id") == ["mended", "held"]
    assert listed("in_force", sort="-last_data_at", q="held") == ["held"]
    api.call("GET", "/devices", 422, params={"mount_status": "superseded"})
