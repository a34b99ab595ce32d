"""The command `livella`: its words. The work is in `api.commands`, which each command loads when it is called."""

from pathlib import Path
from typing import Annotated, Literal

import typer

app = typer.Typer(
    name="livella",
    help="Automatic mounting-angle calibration for vehicle black boxes.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

db = typer.Typer(help="Bring the database up to date, back it up, restore it, check it.", no_args_is_help=True)
keys = typer.Typer(help="Administer the keys, on the service's own machine.", no_args_is_help=True)
app.add_typer(db, name="db")
app.add_typer(keys, name="keys")

DatabaseUrl = Annotated[
    str | None, typer.Option(help="postgresql://... or sqlite:///... [default: a SQLite file in the data directory]")
]
DataDir = Annotated[Path | None, typer.Option(help="Directory for the data. [default: data]")]
LogFormat = Annotated[
    Literal["csv", "thesis", "arrow"] | None,
    typer.Option("--format", help="Format of the log; found out if not given."),
]
Course = Annotated[
    Literal["clockwise", "anticlockwise", "auto"], typer.Option(help="Sense of the course in a thesis log.")
]


@app.command()
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on. [default: 127.0.0.1]")] = None,
    port: Annotated[int | None, typer.Option(help="TCP port. [default: 8000]")] = None,
    workers: Annotated[int | None, typer.Option(help="Server processes. [default: 1]")] = None,
    database_url: DatabaseUrl = None,
    data_dir: DataDir = None,
) -> None:
    """Migrate the database, then run the service and the page. Settings not given come from the environment."""
    from api.commands import serve as command

    command.run({"host": host, "port": port, "workers": workers, "database_url": database_url, "data_dir": data_dir})


@app.command()
def replay(
    logs: Annotated[list[Path], typer.Argument(help="Log files, each of a device of its own.", show_default=False)],
    log_format: LogFormat = None,
    preset: Annotated[Literal["default", "thesis"], typer.Option(help="Parameters of the estimator.")] = "default",
    every: Annotated[float, typer.Option(min=0.01, help="Seconds of log time between estimates with --json.")] = 1.0,
    course: Course = "auto",
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on each line.")] = False,
) -> None:
    """Run the estimator over log files: native CSV, Arrow or thesis logs, plain or compressed with gzip or zstd.

    Exit status 2 when a file could not be read; the others are processed all the same.
    """
    from api.commands import replay as command
    from api.formats import Sense
    from api.formats.files import Format

    command.run(logs, log_format and Format(log_format), preset, every, Sense(course), as_json)


@app.command()
def motion(
    log: Annotated[Path, typer.Argument(help="Log file.", show_default=False)],
    vehicle: Annotated[
        str,
        typer.Option(
            metavar="FILE|CLASS",
            help="Vehicle: a file in TOML, or city_car, sedan, suv, van, truck, bus.",
            show_default=False,
        ),
    ],
    mount: Annotated[
        str | None,
        typer.Option(metavar="YAW,PITCH,ROLL", help="Mounting, degrees; if not given, the estimator finds it first."),
    ] = None,
    latency: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=1.0,
            help="Seconds by which fixes come late; if not given, as the estimator finds them, 0 with --mount.",
        ),
    ] = None,
    every: Annotated[float, typer.Option(min=0.01, help="Seconds of log time between rows with --json.")] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on each line.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Picture to write, .png, .svg or .pdf.", show_default=False)] = None,
    log_format: LogFormat = None,
    course: Course = "auto",
) -> None:
    """Reconstruct the motion of a vehicle: trajectory, velocity, acceleration, attitude, sideslip.

    Exit status 2 when the log cannot be read, or does not show how the device is mounted.
    """
    from api.commands import motion as command
    from api.formats import Sense
    from api.formats.files import Format

    chosen = log_format and Format(log_format)
    command.run(log, chosen, Sense(course), vehicle, mount, latency, every, as_json, plot)


@app.command()
def calibrate(
    logs: Annotated[
        list[Path], typer.Argument(help="Logs of one device that lay still in nine poses.", show_default=False)
    ],
    log_format: LogFormat = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    out: Annotated[
        Path | None, typer.Option("--output", help="File for the device's setting, JSON.", show_default=False)
    ] = None,
) -> None:
    """Find gains and offsets of an accelerometer from poses in which it lay still.

    Exit status 2 when a log cannot be read or its poses are not enough.
    """
    from api.commands import calibrate as command
    from api.formats.files import Format

    command.run(logs, log_format and Format(log_format), as_json, out)


@app.command()
def attitude(
    log: Annotated[Path, typer.Argument(help="Log of a device with a gyroscope.", show_default=False)],
    filter_name: Annotated[
        Literal["linear", "ekf", "madgwick", "quest-ekf", "gyro"],
        typer.Option("--filter", help="How the sensors are put together; gyro integrates only."),
    ] = "ekf",
    log_format: LogFormat = None,
    every: Annotated[float, typer.Option(min=0.001, help="Seconds of log time between lines with --json.")] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on each line.")] = False,
    plot: Annotated[
        Path | None, typer.Option(help="File for a picture, .png, .svg or .pdf.", show_default=False)
    ] = None,
) -> None:
    """Find a device's roll, pitch and heading through a log, from its own sensors.

    Exit status 2 when the log cannot be read or has no gyroscope.
    """
    from api.commands import attitude as command
    from api.formats.files import Format

    command.run(log, log_format and Format(log_format), filter_name, every, as_json, plot)


@app.command()
def characterise(
    log: Annotated[Path, typer.Argument(help="Log of a device that lay still.", show_default=False)],
    log_format: LogFormat = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    plot: Annotated[
        Path | None, typer.Option(help="File for a picture, .png, .svg or .pdf.", show_default=False)
    ] = None,
) -> None:
    """Find means, drifts and noises of a device's sensors, with their Allan deviation.

    Exit status 2 when the log cannot be read or is too short.
    """
    from api.commands import characterise as command
    from api.formats.files import Format

    command.run(log, log_format and Format(log_format), as_json, plot)


@app.command()
def steering(
    source: Annotated[
        Path, typer.Argument(metavar="VIDEO|LOG", help="Film of the wheel, or log of the vehicle.", show_default=False)
    ],
    wheel: Annotated[
        Path | None, typer.Option("--wheel", "--second", help="Log of the device on the wheel.", show_default=False)
    ] = None,
    log: Annotated[Path | None, typer.Option(help="With a film: log of the vehicle.", show_default=False)] = None,
    video_start: Annotated[
        float | None, typer.Option(help="Time of the first frame on the log's clock, s. [default: from the yaw rate]")
    ] = None,
    straight: Annotated[
        float | None,
        typer.Option(help="Time at which the wheel is straight, s. [default: from the drive, or the start]"),
    ] = None,
    from_behind: Annotated[
        bool, typer.Option("--from-behind", help="The camera sees the wheel from the windscreen.")
    ] = False,
    colour: Annotated[
        Literal["red", "orange", "yellow", "green", "cyan", "blue", "pink"] | None,
        typer.Option(help="Colour of the markers; found out if not given."),
    ] = None,
    log_format: LogFormat = None,
    every: Annotated[float, typer.Option(min=0.001, help="Seconds between the angles that are printed.")] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on each line.")] = False,
    out: Annotated[
        Path | None, typer.Option("--output", help="Write LOG as native CSV with a column `steer`.", show_default=False)
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the angle, .png, .svg or .pdf.", show_default=False)] = None,
) -> None:
    """Find the steering-wheel angle from a second device on the wheel, or from a film of markers on it.

    Exit status 2 when a file cannot be read or does not show the angle.
    """
    from api.commands import steering as command
    from api.formats.files import Format

    chosen = log_format and Format(log_format)
    options = (wheel, log, video_start, straight, from_behind, colour, chosen, every, as_json, out, plot)
    command.run(source, command.Options(*options))


@app.command()
def simulate(
    out: Annotated[Path, typer.Argument(help="Log to write, .csv or .csv.gz.", show_default=False)],
    route: Annotated[
        str,
        typer.Option(
            help="Kind of drive: city, hills, straight, motorway, parked, roundabout, curves, constant, steep, crawl, "
            "harsh, towed or ferry."
        ),
    ] = "city",
    seconds: Annotated[float, typer.Option(min=1.0, max=86400.0, help="Length of the drive.")] = 600.0,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same drive.")] = 0,
    mount: Annotated[
        str | None, typer.Option(metavar="YAW,PITCH,ROLL", help="Mounting, degrees; if not given, any, from the seed.")
    ] = None,
    sensor: Annotated[str, typer.Option(help="Quality of the sensors: tmd2, mems or calibrated.")] = "mems",
    remount_at: Annotated[
        str | None,
        typer.Option(metavar="S,YAW,PITCH,ROLL", help="Turn the device to another mounting after S seconds."),
    ] = None,
) -> None:
    """Write a simulated drive, and what is true of it to OUT.truth.json."""
    from api.commands import simulate as command

    command.run(out, route, seconds, seed, mount, sensor, remount_at)


@app.command()
def upload(
    log: Annotated[Path, typer.Argument(help="Log file.", show_default=False)],
    server: Annotated[str, typer.Option(help="Address of the service, http://...", show_default=False)],
    device: Annotated[str, typer.Option(help="Identity of the device.", show_default=False)],
    key: Annotated[
        str, typer.Option(envvar="LIVELLA_KEY", help="Key of the device.", show_default=False, show_envvar=True)
    ],
    log_format: LogFormat = None,
    course: Course = "auto",
    chunk_seconds: Annotated[float, typer.Option(min=0.1, help="Seconds of log time in a chunk.")] = 60.0,
    realtime: Annotated[
        float | None, typer.Option(min=0.001, help="Send at this many times the speed of time; if not given, at once.")
    ] = None,
    session: Annotated[
        str | None, typer.Option(help="Name of the session; if not given, made from the log, so that a repeat resumes.")
    ] = None,
    register: Annotated[
        bool, typer.Option("--register", help="Register the device if it is not there; needs an installer's key.")
    ] = False,
) -> None:
    """Play a device: send a log in chunks, trying again when the service is away.

    Exit status 1 when the service refuses or stays away, 2 when the log cannot be read.
    """
    from api.commands import upload as command
    from api.formats.files import Format

    chosen = log_format and Format(log_format)
    command.run(log, server, device, key, chosen, course, chunk_seconds, realtime, session, register)


@app.command()
def demo(port: Annotated[int, typer.Option(min=1, max=65535, help="TCP port.")] = 8000) -> None:
    """Run the service with a simulated fleet in various states, for a first look. Nothing is kept."""
    from api.commands import demo as command

    command.run(port)


@keys.command("list")
def keys_list(database_url: DatabaseUrl = None, data_dir: DataDir = None) -> None:
    """List the keys; what they open, not the keys themselves, which are not stored."""
    from api.commands import keys as command

    command.show({"database_url": database_url, "data_dir": data_dir})


@keys.command("create")
def keys_create(
    role: Annotated[Literal["device", "installer", "manager", "admin"], typer.Option(show_default=False)],
    name: Annotated[str, typer.Option(help="Whose it is, for the list.", show_default=False)] = "",
    device: Annotated[
        str | None, typer.Option(help="With the role device: the device it is for.", show_default=False)
    ] = None,
    expires_days: Annotated[
        float | None, typer.Option(min=0.001, max=36500, help="Days until it ends; if not given, when it is revoked.")
    ] = None,
    database_url: DatabaseUrl = None,
    data_dir: DataDir = None,
) -> None:
    """Make a key and print it, once."""
    from api.commands import keys as command

    command.create({"database_url": database_url, "data_dir": data_dir}, role, name, device, expires_days)


@keys.command("revoke")
def keys_revoke(
    number: Annotated[int, typer.Argument(help="Number of the key in the list.", show_default=False)],
    database_url: DatabaseUrl = None,
    data_dir: DataDir = None,
) -> None:
    """Revoke a key; whoever signed in with it is signed out."""
    from api.commands import keys as command

    command.revoke({"database_url": database_url, "data_dir": data_dir}, number)


@db.command("migrate")
def db_migrate(database_url: DatabaseUrl = None, data_dir: DataDir = None) -> None:
    """Apply the migrations that are missing; `livella serve` does so by itself."""
    from api.commands import db as command

    command.migrate({"database_url": database_url, "data_dir": data_dir})


@db.command("backup")
def db_backup(
    out: Annotated[Path, typer.Argument(help="File to write.", show_default=False)],
    database_url: DatabaseUrl = None,
    data_dir: DataDir = None,
) -> None:
    """Write a consistent copy of the database to a file, also while the service runs."""
    from api.commands import db as command

    command.backup({"database_url": database_url, "data_dir": data_dir}, out)


@db.command("restore")
def db_restore(
    source: Annotated[Path, typer.Argument(help="File made by `livella db backup`.", show_default=False)],
    replace: Annotated[bool, typer.Option("--replace", help="Give up what is in the database now.")] = False,
    database_url: DatabaseUrl = None,
    data_dir: DataDir = None,
) -> None:
    """Put a backup in the place of the database. Stop the service before."""
    from api.commands import db as command

    command.restore({"database_url": database_url, "data_dir": data_dir}, source, replace)


@db.command("check")
def db_check(database_url: DatabaseUrl = None, data_dir: DataDir = None) -> None:
    """Look for damage in the database, also while the service runs."""
    from api.commands import db as command

    command.check({"database_url": database_url, "data_dir": data_dir})


@app.command()
def openapi() -> None:
    """Print the OpenAPI document."""
    import json

    from api.app import create_app
    from api.settings import Settings

    typer.echo(json.dumps(create_app(Settings()).openapi(), indent=2))


def main() -> None:
    """Run the command."""
    app()


if __name__ == "__main__":
    main()
