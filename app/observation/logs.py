"""Logs: one line an event on standard error, JSON for programs or plain for people."""

import logging
import sys
from dataclasses import dataclass
from typing import Any, Final

import orjson
import structlog

JSON: Final = "json"
CONSOLE: Final = "console"
FORMATS: Final = (JSON, CONSOLE)
LEVELS: Final = ("debug", "info", "warning", "error")


@dataclass(frozen=True)
class LogOptions:
    """How a process logs.

    Attributes:
        log_format: one of FORMATS.
        level: one of LEVELS; what is below is dropped.
    """

    log_format: str = JSON
    level: str = "info"


def configure_logs(options: LogOptions) -> None:
    """Send everything that is logged in this process through one formatter.

    Uvicorn's loggers, warnings and whatever else uses `logging` come the same way. What is bound
    with structlog's context variables, such as the request's id, is on every line of its context.
    """
    before: list[Any] = [
        structlog.contextvars.merge_contextvars,
        structlog.stdlib.add_log_level,
        structlog.stdlib.add_logger_name,
        structlog.stdlib.ExtraAdder(),
        structlog.processors.TimeStamper(fmt="iso", utc=True),
        structlog.processors.CallsiteParameterAdder(
            [structlog.processors.CallsiteParameter.PROCESS]
        ),
    ]
    if options.log_format == JSON:
        last: list[Any] = [
            structlog.processors.format_exc_info,
            structlog.processors.JSONRenderer(serializer=_to_json),
        ]
    else:
        # Plain tracebacks: the pretty ones print local variables, and so what a client sent.
        plain = structlog.dev.plain_traceback
        last = [structlog.dev.ConsoleRenderer(colors=False, exception_formatter=plain)]
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=before,
            processors=[structlog.stdlib.ProcessorFormatter.remove_processors_meta, *last],
        )
    )
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(options.level.upper())
    logging.captureWarnings(True)
    for name, least in _CHATTY.items():
        logging.getLogger(name).setLevel(max(least, root.level))


# What these say below is about themselves, a line for every step.
_CHATTY: Final = {
    "alembic": logging.WARNING,
    "asyncio": logging.WARNING,
    "matplotlib": logging.WARNING,
    "numba": logging.WARNING,
    "sqlalchemy": logging.WARNING,
    "uvicorn.error": logging.WARNING,
    "websockets": logging.WARNING,
}


def _to_json(values: Any, **_: Any) -> str:
    return orjson.dumps(values, default=str, option=orjson.OPT_NON_STR_KEYS).decode(
        errors="replace"
    )
