"""The API's documents. Names, units and meanings are fixed by the contract; angles in degrees, else SI, times UTC."""

from datetime import datetime
from typing import Annotated, Any, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import AwareDatetime, BaseModel, ConfigDict, Field, StringConstraints, model_validator

import core

Role = Literal["device", "installer", "manager", "admin"]
StageName = Literal["waiting", "aligning", "settling", "verifying", "confirmed"]
Need = Literal["data", "gps_fix", "motion", "turn", "accelerate_or_brake", "time"]
MountStatus = Literal["in_force", "suspect", "superseded"]
CurrentMountStatus = Literal["in_force", "suspect"]
VerificationState = Literal["idle", "running", "passed", "failed"]
ChunkState = Literal["applied", "waiting"]
AlertKind = Literal[
    "orientation_changed",
    "device_loose",
    "calibration_stalled",
    "verification_failing",
    "gps_lost",
    "sensor_fault",
    "device_silent",
    "clock_fault",
    "impact",
    "harsh_driving",
]
MotionEventKind = Literal["impact", "harsh_braking", "harsh_acceleration", "harsh_cornering", "pothole"]
VehicleClass = Literal["city_car", "sedan", "suv", "van", "truck", "bus"]
RawFormat = Literal["arrow", "csv"]
Severity = Literal["info", "warning", "critical"]
AlertState = Literal["open", "acknowledged", "resolved"]
DeviceOrder = Literal["id", "-id", "name", "-name", "last_data_at", "-last_data_at"]
ThresholdGroup = Literal["settling", "verification", "change", "events", "alerts", "upload", "retention"]

Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]
Matrix3 = tuple[Vector3, Vector3, Vector3]
WebhookEvent = Literal["alert.opened", "alert.updated", "alert.acknowledged", "alert.resolved", "test"]
DeliveryState = Literal["pending", "delivered", "failed"]

DEVICE_ID = r"^[A-Za-z0-9][A-Za-z0-9._:-]{0,63}$"
NO_NUL = r"^[^\x00]*$"
"""PostgreSQL keeps no text with the character 0."""
DeviceId = Annotated[str, StringConstraints(pattern=DEVICE_ID, max_length=64)]
SessionName = Annotated[str, StringConstraints(pattern=r"^[\x21-\x7e]{1,128}$", max_length=128)]
Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=128, pattern=NO_NUL)]
Notes = Annotated[str, StringConstraints(max_length=4000, pattern=NO_NUL)]
Words = Annotated[str, StringConstraints(max_length=128, pattern=NO_NUL)]
WebhookUrl = Annotated[str, StringConstraints(min_length=1, max_length=2048, pattern=r"^[\x21-\x7e]+$")]
Kinds = Annotated[list[AlertKind], Field(min_length=1, max_length=32)]
Severities = Annotated[list[Severity], Field(min_length=1, max_length=8)]

TRACE_ROWS = 130

T = TypeVar("T")


class Document(BaseModel):
    """Base of the API's documents: what is not described is refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Page(Document, Generic[T]):
    """One page of a list."""

    items: list[T]
    next_cursor: str | None = Field(description="Give it as `cursor` to get the next page; null on the last page.")


# ---------------------------------------------------------------- problems


class ProblemItem(Document):
    """One thing that is wrong, and where."""

    pointer: str | None = Field(
        None, description="JSON pointer into the request: `/body/...`, `/query/...`, `/path/...`."
    )
    line: int | None = Field(None, description="Line of the log, from 1.")
    column: str | int | None = Field(None, description="Column of the log: its name, or its number from 1.")
    expected: str | None = None
    message: str


class Problem(Document):
    """RFC 9457 problem details."""

    type: str
    title: str
    status: int
    detail: str
    errors: list[ProblemItem] = Field(default_factory=list)


# ---------------------------------------------------------------- mounting


class Angles(Document):
    """Roll, pitch, yaw of the device in the vehicle, degrees, intrinsic z-y'-x''."""

    roll: float
    pitch: float
    yaw: float


class SpeedTrace(Document):
    """The drive test as it went: columns of equal length, about a row for each second of driving that was tested."""

    t: list[float] = Field(description="Session clock, s.", max_length=TRACE_ROWS)
    gps_mps: list[float] = Field(description="Speed that the GPS says, m/s.")
    sensor_mps: list[float] = Field(
        description="Speed that the accelerometer says under the mounting that is tested, m/s; "
        "in the last row of a finished test it differs from the GPS by the error of the test."
    )


class Verification(Document):
    """The drive test."""

    state: VerificationState
    elapsed_s: float = Field(description="Driving tested so far, s.")
    duration_s: float = Field(description="Driving the test takes, s.")
    error_mps: float | None = Field(description="Speed error of the test so far, m/s.")
    limit_mps: float = Field(description="Largest error that passes, m/s.")
    trace: SpeedTrace | None = Field(
        description="Of the running or the last test; null before the first, and of tests from before traces were kept."
    )


class Estimate(Document):
    """The estimate now."""

    t: float = Field(description="Session clock, s.")
    quaternion: Vector4 = Field(description="q_vs, scalar first.")
    matrix: Matrix3 = Field(description="R(q_vs), rows: f_v = R f_s.")
    angles_deg: Angles
    sigma_deg: Vector3 = Field(description="1 sigma about the vehicle's x, y and z axes.")
    stable: bool
    reliable: bool


class Mount(Document):
    """A confirmed mounting."""

    id: int = Field(description="Number of the mounting, from 1 for each device.")
    quaternion: Vector4
    matrix: Matrix3
    angles_deg: Angles
    sigma_deg: Vector3
    confirmed_at: datetime
    status: MountStatus
    verification: Verification


class Limits(Document):
    """What an estimate's 1 sigma must be below before a mounting is confirmed, degrees."""

    yaw_sigma_deg: float = Field(description="About the vehicle's z axis.")
    tilt_sigma_deg: float = Field(description="About the vehicle's x and y axes.")


class LastData(Document):
    """What the last applied chunk that had samples was like."""

    session: str
    sample_rate_hz: float | None = Field(description="IMU samples used a second; null of fewer than two.")
    fix_rate_hz: float | None = Field(description="Valid GPS fixes used a second.")
    has_fix: bool = Field(description="The receiver had a valid fix when it reported last.")
    speed_mps: float | None = Field(description="Speed over ground at the last valid fix of the chunk.")
    gyroscope: bool = Field(description="There are readings of a gyroscope.")
    span_s: float = Field(description="Time from the first to the last sample, s.")
    rejected: dict[str, int] = Field(description="Samples and fixes not used, by reason.")


class Installation(Document):
    """Where an installation stands."""

    device_id: str
    stage: StageName
    since: datetime = Field(description="When this stage began.")
    progress: float = Field(ge=0, le=1)
    needs: list[Need]
    hint: str = Field(description="What is missing now, in words for the driver or installer.")
    estimate: Estimate | None
    verification: Verification
    mount: Mount | None = Field(description="The mounting in force, or the suspect one.")
    limits: Limits
    open_alerts: int
    last_data_at: datetime | None = Field(description="When the last data came in.")
    data: LastData | None = Field(description="What the last data were like; null before the first.")
    revision: int = Field(description="Rises with every change.")


class AngleColumns(Document):
    """Angles as columns, degrees."""

    roll: list[float]
    pitch: list[float]
    yaw: list[float]


class Estimates(Document):
    """Angle history, columns of equal length in time order."""

    session: list[str]
    t: list[float] = Field(description="Session clock, s.")
    time: list[datetime]
    quaternion: list[Vector4]
    angles_deg: AngleColumns
    sigma_deg: list[Vector3]
    stage: list[StageName]
    stable: list[bool]
    reliable: list[bool]
    progress: list[float]


# ---------------------------------------------------------------- motion


class MotionEvent(Document):
    """Something that happened to the vehicle, seen in its own axes under the mounting in force."""

    id: int
    kind: MotionEventKind
    at: datetime = Field(description="When it was strongest.")
    start_at: datetime
    duration_s: float
    peak_mps2: float = Field(
        description="Largest acceleration, gravity taken out: on the plan; of a pothole along the vehicle's vertical."
    )
    direction_deg: float | None = Field(
        description="Where the push came from, anti-clockwise from forward: 0 the front, 90 the left, -90 the right; "
        "null of a pothole."
    )
    speed_change_mps: tuple[float, float] = Field(description="Forward and to the left, from its start to its end.")
    speed_mps: float | None = Field(description="Speed over ground before it; null when not known.")
    mount: int = Field(description="Number of the mounting it was seen under.")
    session: str
    t: float = Field(description="Session clock when it was strongest, s.")
    kept: bool = Field(description="The samples around it are there to be read: `/raw`, `/motion`.")


class Origin(Document):
    """Where east, north and up are zero."""

    lat: float = Field(description="Degrees.")
    lon: float = Field(description="Degrees.")
    alt: float | None = Field(description="m; null when not known.")


class MotionColumns(Document):
    """Columns of equal length in time order; null is what is not known."""

    session: list[str]
    t: list[float] = Field(description="Session clock, s.")
    at: list[datetime]
    speed_mps: list[float | None] = Field(description="Forward; negative in reverse.")
    longitudinal_mps2: list[float | None] = Field(description="Acceleration forward, gravity taken out.")
    lateral_mps2: list[float | None] = Field(description="To the left.")
    vertical_mps2: list[float | None] = Field(description="Up.")
    yaw_rate_dps: list[float | None] = Field(description="Positive to the left.")
    roll_deg: list[float | None] = Field(description="Positive to the right.")
    pitch_deg: list[float | None] = Field(description="Positive nose down.")
    heading_deg: list[float | None] = Field(description="Clockwise from north, 0 to 360.")
    quaternion: list[Vector4 | None] = Field(description="q_nv, scalar first: vehicle to east, north, up.")
    sideslip_deg: list[float | None] = Field(description="Of the velocity against forward, to the left.")
    sideslip_sigma_deg: list[float | None]
    east_m: list[float | None] = Field(description="From the origin.")
    north_m: list[float | None]
    up_m: list[float | None]
    position_sigma_m: list[float | None] = Field(description="1 sigma per horizontal axis.")
    dead_reckoned: list[bool] = Field(description="No fix came for a while: velocity and position are carried on.")


class Motion(Document):
    """Motion of the vehicle, computed from the samples kept, under the mounting that was in force then."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    device_id: str
    vehicle: VehicleClass = Field(description="The class of the device, `sedan` where none is given.")
    start: datetime = Field(alias="from", description="Later than asked for where the mounting came into force later.")
    end: datetime = Field(alias="to", description="Earlier than asked for where the mounting was in doubt earlier.")
    mount: int | None = Field(description="Number of the mounting; null, and no rows, where none was in force.")
    origin: Origin | None = Field(description="Null before the first fix.")
    columns: MotionColumns


# ---------------------------------------------------------------- devices and chunks


class AccelerometerCalibration(Document):
    """Errors of a device's accelerometer: it reads gain f + offset; `livella calibrate` finds them."""

    gain: Matrix3 = Field(
        description="Symmetric, no unit: gains of x, y, z from 0.8 to 1.2, cross gains less than 0.2 in size."
    )
    offset: Vector3 = Field(description="m/s2, each less than 3 in size.")

    @model_validator(mode="after")
    def _check(self) -> Self:
        gain, offset = np.array(self.gain), np.array(self.offset)
        core.accelerometer.check(core.AccelerometerCalibration(gain, offset))
        return self


class DeviceDraft(Document):
    """A device to register."""

    id: DeviceId | None = Field(None, description="Chosen at random when left out.")
    name: Name
    vehicle: Name | None = None
    notes: Notes | None = None
    accelerometer_calibration: AccelerometerCalibration | None = None
    vehicle_class: VehicleClass | None = Field(None, description="Its usual dimensions are computed with; null: sedan.")


class DevicePatch(Document):
    """What to change of a device; what is left out stays."""

    name: Name = Field("", description="Not null: a device always has a name.")
    vehicle: Name | None = None
    notes: Notes | None = None
    accelerometer_calibration: AccelerometerCalibration | None = Field(
        None,
        description="Tells on the chunks applied from now on; with a mounting, restart the installation afterwards.",
    )
    vehicle_class: VehicleClass | None = None


class Device(Document):
    """A device, with a summary of its installation."""

    id: str
    name: str
    vehicle: str | None
    notes: str | None
    accelerometer_calibration: AccelerometerCalibration | None
    created_at: datetime
    stage: StageName
    progress: float
    mount_status: MountStatus | None
    open_alerts: int
    last_data_at: datetime | None
    revision: int
    vehicle_class: VehicleClass | None


class RegisteredDevice(Document):
    """A device just registered, with its key, which is shown only now."""

    device: Device
    key: str


class Chunk(Document):
    """Receipt of a chunk."""

    session: str
    seq: int
    samples: int = Field(description="IMU samples used; of a waiting chunk, read.")
    fixes: int = Field(description="GPS fixes used; of a waiting chunk, read.")
    rejected: dict[str, int] = Field(description="Samples and fixes not used, by reason.")
    duplicate: bool
    state: ChunkState
    notices: list[str] = Field(description="What the sender should know, such as columns that were ignored.")


class Upload(Document):
    """Answer to an upload."""

    chunk: Chunk
    installation: Installation


class LostChunks(Document):
    """Numbers of a session that never came, although later ones were applied."""

    session: str
    from_seq: int
    to_seq: int = Field(description="The last of them.")
    before: datetime = Field(description="When the chunk after them came in.")


class SessionReception(Document):
    """What came in of a session."""

    session: str
    started_at: datetime | None = Field(description="Zero of the session's clock, as far as it is known.")
    first_seq: int
    last_seq: int
    chunks: int
    samples: int
    fixes: int


class ReceptionRates(Document):
    """Chunks in the order in which they came in: columns of equal length."""

    time: list[datetime] = Field(description="When the chunk came in.")
    sample_rate_hz: list[float | None] = Field(description="Null where it is not known.")
    fix_rate_hz: list[float | None] = Field(description="Null where it is not known.")
    rejected: list[int] = Field(description="Samples and fixes not used.")


class Reception(Document):
    """What became of the data of a device that came in within a period."""

    since: datetime = Field(description="Later than asked for when receipts are not kept as long, or are too many.")
    until: datetime
    chunks: int
    samples: int
    fixes: int
    rejected: dict[str, int] = Field(description="Samples and fixes not used, by reason.")
    waiting: int = Field(description="Chunks that are ahead of their turn.")
    lost: list[LostChunks] = Field(description="Newest first, at most 100.")
    sessions: list[SessionReception] = Field(description="Newest first, at most 20.")
    rates: ReceptionRates = Field(description="At most 500 rows; of more chunks evenly chosen ones.")


# ---------------------------------------------------------------- alerts, webhooks, stream, sessions


class Alert(Document):
    """A finding somebody should know about."""

    id: int
    device_id: str
    kind: AlertKind
    severity: Severity
    state: AlertState
    opened_at: datetime
    updated_at: datetime
    count: int = Field(description="How often the condition was seen while the alert was open.")
    message: str
    data: dict[str, Any] = Field(description="What was found, in numbers; null is what is not known.")
    acknowledged_at: datetime | None
    acknowledged_by: str | None
    acknowledge_note: str | None
    resolved_at: datetime | None
    resolved_by: str | None
    resolve_note: str | None


class AlertNote(Document):
    """A remark by whoever acknowledges or resolves an alert."""

    note: Notes | None = None


class WebhookDraft(Document):
    """A webhook to make: called when an alert changes."""

    name: Name
    url: WebhookUrl
    kinds: Kinds | None = Field(None, description="Kinds of alerts it is called for; null for all.")
    severities: Severities | None = Field(None, description="Severities of alerts it is called for; null for all.")
    active: bool = True


class WebhookPatch(Document):
    """What to change of a webhook; what is left out stays."""

    name: Name = Field("", description="Not null: a webhook always has a name.")
    url: WebhookUrl = Field("", description="Not null.")
    kinds: Kinds | None = None
    severities: Severities | None = None
    active: bool = Field(True, description="Not null. Alerts that change meanwhile are not told later.")


class Webhook(Document):
    """A webhook, without its secret."""

    id: int
    name: str
    url: str
    kinds: list[AlertKind] | None
    severities: list[Severity] | None
    active: bool = Field(description="False when it was switched off, also by its receiver's answer 410.")
    created_at: datetime
    created_by: str | None
    failing_since: datetime | None = Field(description="The first call that failed since the last one that did not.")
    last_success_at: datetime | None


class WebhookSecret(Document):
    """A webhook with a new secret, which is shown only now."""

    webhook: Webhook
    secret: str = Field(description="`whsec_` and the key in base64, as the libraries of Standard Webhooks take it.")


class WebhookDelivery(Document):
    """A message to a webhook, and what became of it."""

    id: int
    message_id: str = Field(description="Sent as `webhook-id`, the same with every attempt.")
    type: WebhookEvent
    device_id: str | None
    state: DeliveryState
    attempts: int
    created_at: datetime
    next_attempt_at: datetime | None
    last_attempt_at: datetime | None
    last_status: int | None = Field(description="HTTP status of the last answer, if there was one.")
    last_error: str | None
    duration_ms: int | None = Field(description="How long the last attempt took.")


class WebhookTest(Document):
    """How a test call ended."""

    delivered: bool
    status: int | None = Field(description="HTTP status of the answer, if there was one.")
    error: str | None
    duration_ms: int


class Redelivery(Document):
    """Deliveries that are tried anew."""

    deliveries: int


class DeviceChange(Document):
    """Data of the stream's `device` event."""

    device_id: str
    change: Literal["registered", "edited", "removed"]
    device: Device | None = Field(description="Null when it was removed.")


class FleetSummary(Document):
    """Counts over the devices one may see."""

    devices: int
    stages: dict[StageName, int]
    open_alerts: int
    alerts: dict[AlertKind, dict[Severity, int]] = Field(description="Open alerts by kind and severity.")
    severities: dict[Severity, int] = Field(description="Devices with an open alert of each severity.")
    silent: int = Field(description="Devices with an open alert `device_silent`.")
    suspect: int = Field(description="Devices whose mounting is suspect.")


class Threshold(Document):
    """One of the numbers the service decides by."""

    name: str = Field(description="As in the tables of `core/`, `api/services/rules/limits.py` and the settings.")
    group: ThresholdGroup
    value: int | float | str = Field(description="`infinite` is the only text.")
    unit: str = Field(description="Such as `deg`, `s`, `m/s`; empty when it is a mere number.")
    meaning: str


class Thresholds(Document):
    """What the service decides by."""

    items: list[Threshold]


class KeyDraft(Document):
    """A key to make."""

    role: Role
    name: Name
    device_id: DeviceId | None = Field(None, description="Only with the role device: the device the key is for.")
    expires_at: AwareDatetime | None = Field(None, description="When it ends; null: when it is revoked.")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.role == "device") != (self.device_id is not None):
            raise ValueError("`device_id` goes with the role device, and with no other")
        return self


class Key(Document):
    """A key, without its secret, which is not stored."""

    id: int
    prefix: str | None = Field(description="How it begins; null of keys made long ago or chosen by an operator.")
    role: Role
    name: str
    device_id: str | None
    created_at: datetime
    created_by: str | None = Field(description="Name of the key it was made with.")
    last_used_at: datetime | None = Field(description="Some minutes behind at most.")
    expires_at: datetime | None


class CreatedKey(Key):
    """A key just made, which is shown only now."""

    key: str


class AuditEntry(Document):
    """Something somebody did."""

    id: int
    at: datetime
    actor: str = Field(description="Name of the key it was done with, at that time.")
    key_id: int | None
    role: Role | Literal["none"]
    action: str = Field(description="`resource.verb`.")
    target: str | None = Field(description="Path of what was changed, below `/api/v1/`.")
    detail: dict[str, Any] | None
    request_id: str | None


class SignIn(Document):
    """A key to sign in with."""

    key: Annotated[str, StringConstraints(min_length=1, max_length=512)]


class SignedIn(Document):
    """Who is signed in."""

    role: Role
    name: str
    device_id: str | None


class Health(Document):
    """State of the service."""

    status: Literal["ok", "starting", "unavailable"]
