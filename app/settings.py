"""Settings of the service, from the environment (prefix PRUNUS_) or given."""

from pathlib import Path

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict
from sqlalchemy import URL, make_url


class Settings(BaseSettings):
    """What an operator may set; each field is PRUNUS_ and its name in capitals.

    Attributes:
        data_dir: folder of the embedded database; made at start-up.
        database_url: an SQLAlchemy URL; empty: SQLite in `data_dir`.
        workers: processes that solve.
        body_limit_bytes: larger request bodies get 413.
        sync_targets_limit: larger batches are refused.
    """

    model_config = SettingsConfigDict(env_prefix="PRUNUS_", extra="forbid", frozen=True)

    host: str = "127.0.0.1"
    port: int = Field(default=8000, ge=0, le=65535)
    data_dir: Path = Path("prunus-data")
    database_url: str = ""
    workers: int = Field(default=2, ge=1, le=64)
    body_limit_bytes: int = Field(default=8 * 1024 * 1024, ge=1024)
    sync_targets_limit: int = Field(default=2000, ge=1)

    @property
    def resolved_database_url(self) -> URL:
        """The database's URL with the default filled in."""
        if self.database_url:
            url = make_url(self.database_url)
            # What PostgreSQL's own tools call it; without a driver SQLAlchemy takes another one.
            postgresql = url.drivername in ("postgresql", "postgres")
            return url.set(drivername="postgresql+psycopg") if postgresql else url
        return URL.create("sqlite", database=str(self.data_dir.resolve() / "prunus.sqlite3"))
