"""Every setting of the service: name, meaning, unit, default. `docs/settings.md` is made from this file."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, SecretStr
from pydantic_settings import BaseSettings, SettingsConfigDict

PREFIX = "LIVELLA_"
MIB = 1024 * 1024


class Settings(BaseSettings):
    """Read from the environment, each name with `LIVELLA_` in front; the command line's flags go before it."""

    model_config = SettingsConfigDict(env_prefix=PREFIX, extra="forbid", frozen=True)

    host: str = Field("127.0.0.1", description="Address to listen on; `0.0.0.0` for every network interface.")
    port: int = Field(8000, ge=0, le=65535, description="TCP port to listen on.")
    workers: int = Field(1, ge=1, le=64, description="Server processes.")
    data_dir: Path = Field(Path("data"), description="Directory of the SQLite database, made when missing.")
    database_url: SecretStr | None = Field(
        None,
        description="Database, `postgresql://user:password@host/name` or `sqlite:///file`; "
        "unset: SQLite file `livella.db` in the data directory.",
    )
    admin_key: SecretStr | None = Field(
        None,
        min_length=1,
        description="First admin key, to be chosen at random (32 characters or more); "
        "unset: one is made at first start and printed once.",
    )
    preset: Literal["default", "thesis"] = Field("default", description="Parameter set of the estimator.")
    estimate_interval: float = Field(
        5.0, ge=0.1, le=3600, description="Seconds of device time between two rows of the angle history."
    )
    max_chunk_bytes: int = Field(16 * MIB, ge=1024, description="Largest chunk as sent, bytes.")
    max_decoded_bytes: int = Field(64 * MIB, ge=1024, description="Largest chunk after decompression, bytes.")
    max_uploads: int = Field(
        256,
        ge=1,
        le=100_000,
        description="Chunks a server process has in work or waiting at once; more are answered with 503.",
    )
    upload_threads: int = Field(
        3,
        ge=1,
        le=64,
        description="Threads of a server process that work on chunks, in batches of 4; "
        "on SQLite one, in batches of 8 to 32.",
    )
    max_inflight_bytes: int = Field(
        256 * MIB,
        ge=1024,
        description="Request bodies as sent that a server process holds at once, bytes; more are answered with 503.",
    )
    body_timeout: float = Field(120.0, gt=0, description="Seconds a request's body may take to arrive.")
    gap_timeout: float = Field(
        600.0, gt=0, description="Seconds a chunk waits for a missing one before it before the gap is declared."
    )
    max_waiting_chunks: int = Field(
        64, ge=1, le=1024, description="Chunks waiting in one session that declare the gap."
    )
    session_hours: float = Field(12.0, gt=0, le=720, description="Hours until a sign-in to the page ends.")
    device_requests_per_minute: int = Field(
        120, ge=1, description="Requests a minute with the key of a device, for each server process."
    )
    requests_per_minute: int = Field(
        1200, ge=1, description="Requests a minute with any other key, for each server process."
    )
    failures_per_minute: int = Field(
        20, ge=1, description="Requests a minute with unknown keys from one address, for each server process."
    )
    forwarded_allow_ips: str | None = Field(
        None,
        description="Proxies whose `X-Forwarded-For` and `X-Forwarded-Proto` are believed: addresses or networks "
        "separated by commas, or `*`; unset: those of `FORWARDED_ALLOW_IPS`, else `127.0.0.1`.",
    )
    history_days: float = Field(
        14.0, gt=0, description="Days the fine angle history is kept; then it becomes one point a minute."
    )
    coarse_history_days: float = Field(
        365.0, gt=0, description="Days the angle history of one point a minute is kept; mountings and alerts stay."
    )
    receipt_days: float = Field(
        14.0, ge=1, description="Days in which a chunk that comes once more is known as a duplicate; later it gets 409."
    )
    raw_retention_days: float = Field(
        7.0,
        ge=0,
        description="Days the samples of devices are kept, from which motion is computed; 0: none are. "
        "Those around an impact stay for as long as their device.",
    )
    delivery_days: float = Field(30.0, ge=4, description="Days the deliveries of webhooks are kept.")
    audit_days: float = Field(730.0, gt=0, description="Days the audit trail is kept.")
    alert_stalled_minutes: float = Field(
        30.0, gt=0, description="Minutes of driving without a confirmed mounting that raise `calibration_stalled`."
    )
    alert_failed_tests: int = Field(
        4, ge=1, le=1000, description="Failed drive tests in a row that raise `verification_failing`."
    )
    alert_gps_lost_minutes: float = Field(
        30.0, gt=0, description="Minutes of data without a GPS fix that raise `gps_lost`."
    )
    alert_silent_hours: float = Field(
        72.0, ge=0.005, le=87600, description="Hours without data that raise `device_silent`; at least 0.005 (18 s)."
    )
    alert_reopen_minutes: float = Field(
        60.0,
        ge=0,
        le=525600,
        description="Minutes after an alert was over by itself in which a recurrence opens it again.",
    )
    stream_minutes: float = Field(
        15.0, gt=0, description="Minutes a live stream that was cut off can be resumed without a gap."
    )
    metrics_token: SecretStr | None = Field(
        None,
        min_length=16,
        description="What Prometheus has to send as `Authorization: Bearer TOKEN` to read `/metrics`; "
        "unset: anybody who reaches the port may.",
    )
    log_format: Literal["text", "json"] = Field("text", description="Log lines for people or for machines.")
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        "info", description="Messages from this level on are logged."
    )
    webhook_allow_private: bool = Field(
        False,
        description="Webhooks may call private, loopback and link-local addresses, and use plain `http`: "
        "only where everybody with a manager key may reach what this machine reaches.",
    )

    @property
    def url(self) -> str:
        """The database's URL."""
        if self.database_url is not None:
            return self.database_url.get_secret_value()
        return f"sqlite:///{self.data_dir.absolute() / 'livella.db'}"


def table() -> str:
    """Give the settings as a Markdown table."""
    rows = [f"| `{PREFIX}{name.upper()}` | {field.description} | {_default(field.default)} |" for name, field in FIELDS]
    return "\n".join(["| variable | meaning and unit | default |", "|---|---|---|", *rows])


def document() -> str:
    """Give `docs/settings.md`."""
    return (
        "# Settings\n\n"
        "Set in the environment; the flags of `livella serve` go before the environment.\n"
        "This page is made from `api/settings.py` by `python -m api.settings > docs/settings.md`.\n\n"
        f"{table()}\n"
    )


FIELDS = tuple(Settings.model_fields.items())


def _default(value: Annotated[object, "a field's default"]) -> str:
    return "unset" if value is None else f"`{value}`"


if __name__ == "__main__":
    print(document(), end="")
