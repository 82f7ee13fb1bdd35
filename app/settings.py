"""Settings of the service: given, from the environment (prefix PRUNUS_), or from a TOML file."""

import ipaddress
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import Field, field_validator
from pydantic_settings import (
    BaseSettings,
    NoDecode,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
    TomlConfigSettingsSource,
)
from sqlalchemy import URL, make_url
from sqlalchemy.exc import ArgumentError

from app.observation.logs import LogOptions

DATABASES: Final = ("sqlite", "postgresql", "postgres")
# As browsers write it: lower case, and no path.
ORIGIN: Final = re.compile(r"https?://([a-z0-9.-]+|\[[0-9a-f:.]+\])(:[0-9]{1,5})?")


class Settings(BaseSettings):
    """What an operator may set; each field is PRUNUS_ and its name in capitals.

    Attributes:
        data_dir: folder of the embedded database; made at start-up.
        database_url: an SQLAlchemy URL; empty: SQLite in `data_dir`.
        workers: processes that solve.
        body_limit_bytes: larger request bodies get 413.
        sync_targets_limit: larger batches become jobs.
        job_targets_limit: larger batches are refused.
        job_workers: processes that solve jobs, at a lower priority.
        most_waiting_jobs: so many jobs may wait or run.
        log_format: see `app.observation.logs`.
        log_level: what is below is not logged.
        grace_s: requests being answered get this long when the service stops.
        head_timeout_s: for a request's head.
        body_idle_timeout_s: between two pieces of a body.
        body_timeout_s: for a whole body.
        write_timeout_s: a client that reads less than 16 KiB of its answer in this time is dropped.
        keep_alive_s: an idle connection is closed after this.
        require_token: demand a token on loopback too, as behind a reverse proxy.
        rate_limit_per_s, rate_burst: requests of a client, in the long run and at once.
        most_requests: so many are answered at once; of connections there may be twice as many.
        most_waiting_plans: so many wait for a solver process.
        cors_origins: web pages of other origins that may use the service.
    """

    model_config = SettingsConfigDict(env_prefix="PRUNUS_", extra="forbid", frozen=True)

    host: str = "127.0.0.1"
    port: int = Field(default=8000, ge=0, le=65535)
    data_dir: Path = Path("prunus-data")
    database_url: str = ""
    workers: int = Field(default=2, ge=1, le=64)
    body_limit_bytes: int = Field(default=32 * 1024 * 1024, ge=1024)
    sync_targets_limit: int = Field(default=2000, ge=1)
    job_targets_limit: int = Field(default=100_000, ge=1)
    job_workers: int = Field(default=1, ge=1, le=64)
    most_waiting_jobs: int = Field(default=100, ge=1, le=100_000)
    log_format: Literal["json", "console"] = "json"
    log_level: Literal["debug", "info", "warning", "error"] = "info"
    grace_s: float = Field(default=20.0, ge=0, le=3600)
    head_timeout_s: float = Field(default=20.0, ge=0.1, le=3600)
    body_idle_timeout_s: float = Field(default=20.0, ge=0.1, le=3600)
    body_timeout_s: float = Field(default=120.0, ge=0.1, le=3600)
    write_timeout_s: float = Field(default=30.0, ge=0.1, le=3600)
    keep_alive_s: int = Field(default=15, ge=1, le=3600)
    require_token: bool = False
    rate_limit_per_s: float = Field(default=500.0, ge=0.1, le=1e6)
    rate_burst: int = Field(default=1000, ge=1, le=1_000_000)
    most_requests: int = Field(default=500, ge=1, le=100_000)
    most_waiting_plans: int = Field(default=64, ge=0, le=10_000)
    cors_origins: Annotated[tuple[str, ...], NoDecode] = ()

    @field_validator("cors_origins", mode="before")
    @classmethod
    def _split(cls, given: object) -> object:
        """In the environment it is a text with commas."""
        if isinstance(given, str):
            return tuple(part.strip() for part in given.split(",") if part.strip())
        return given

    @field_validator("database_url")
    @classmethod
    def _known_database(cls, url: str) -> str:
        # No error repeats the URL, which may have a password.
        try:
            backend = make_url(url).get_backend_name() if url else "sqlite"
        except (ArgumentError, ValueError):
            raise ValueError("this is no URL of a database") from None
        if backend not in DATABASES:
            raise ValueError("databases are sqlite and postgresql")
        return url

    @field_validator("cors_origins")
    @classmethod
    def _exact(cls, origins: tuple[str, ...]) -> tuple[str, ...]:
        # "*" would let every page in the world move an arm.
        if not all(map(ORIGIN.fullmatch, origins)):
            raise ValueError("an origin is http:// or https://, a name, and a port if need be")
        return origins

    @property
    def token_required(self) -> bool:
        """Whether nothing but open routes answers without a token."""
        return self.require_token or not is_loopback(self.host)

    @property
    def log_options(self) -> LogOptions:
        """How this service's processes log."""
        return LogOptions(self.log_format, self.log_level)

    @property
    def resolved_database_url(self) -> URL:
        """The database's URL with the default filled in."""
        if self.database_url:
            url = make_url(self.database_url)
            # What PostgreSQL's own tools call it; without a driver SQLAlchemy takes another one.
            postgresql = url.drivername in ("postgresql", "postgres")
            return url.set(drivername="postgresql+psycopg") if postgresql else url
        return URL.create("sqlite", database=str(self.data_dir.resolve() / "prunus.sqlite3"))


OTHER_VARIABLES: Final = ("SETTINGS", "ROBOTS_DIR", "URL", "TOKEN", "SERIAL")
"""What else is called PRUNUS_...: of other commands, of models, of clients and units."""


def misspelt_variables(names: Iterable[str]) -> list[str]:
    """Those of the environment's names that look like a setting and are none.

    Ignored, a misspelt PRUNUS_REQUIRE_TOKEN would leave a service open that is thought closed.
    """
    prefix = str(Settings.model_config["env_prefix"])
    known = {f"{prefix}{name}".upper() for name in (*Settings.model_fields, *OTHER_VARIABLES)}
    # Settings are found whatever the case of their names.
    return sorted(
        name for name in names if name.upper().startswith(prefix) and name.upper() not in known
    )


class SettingsFileUnusable(Exception):
    """A settings file that cannot be read, and why in one line."""


def load_settings(file: Path | None, given: dict[str, Any]) -> Settings:
    """What is given goes before the environment, and that before the file.

    Args:
        file: TOML with the settings' names as keys; None: there is none.
        given: options of a command.

    Raises:
        SettingsFileUnusable: the file is not there, not allowed, or no TOML.
        pydantic.ValidationError: a setting makes no sense, or the file has one that is unknown.
    """
    if file is None:
        return Settings(**given)

    class FromFile(Settings):
        @classmethod
        def settings_customise_sources(
            cls,
            settings_cls: type[BaseSettings],
            init_settings: PydanticBaseSettingsSource,
            env_settings: PydanticBaseSettingsSource,
            dotenv_settings: PydanticBaseSettingsSource,
            file_secret_settings: PydanticBaseSettingsSource,
        ) -> tuple[PydanticBaseSettingsSource, ...]:
            return init_settings, env_settings, TomlConfigSettingsSource(settings_cls, file)

    try:
        # The source takes a file that is not there for an empty one.
        file.open("rb").close()
        return FromFile(**given)
    except OSError as error:
        raise SettingsFileUnusable(f"cannot read {file}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        where = f": {error}" if isinstance(error, tomllib.TOMLDecodeError) else ""
        raise SettingsFileUnusable(f"{file} is not TOML{where}") from None


def shown_settings(settings: Settings) -> dict[str, Any]:
    """Every setting by name, with passwords hidden."""
    values = settings.model_dump(mode="json")
    if settings.database_url:
        url = settings.resolved_database_url
        # libpq takes passwords as parameters too.
        hidden = {name: "***" for name in url.query if "password" in name.lower()}
        shown = url.update_query_dict(hidden) if hidden else url
        values["database_url"] = shown.render_as_string(hide_password=True)
    return values


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches a service that listens there."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"
