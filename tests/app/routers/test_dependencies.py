"""One bundle of services, typed, and reached in one way."""

import asyncio
import inspect
import re
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin, get_type_hints
from unittest.mock import Mock

import pytest
from fastapi import FastAPI
from fastapi.requests import HTTPConnection

import app
from app.routers import dependencies
from app.routers.dependencies import AllServices, Services, keep_services

ROOM = Path(app.__file__).parent
UNTYPED = re.compile(r"\bapp\.state\b|\[\"app\"\]")
TYPES = get_type_hints(Services)
GIVEN = {
    name: get_args(value)
    for name, value in vars(dependencies).items()
    if get_origin(value) is Annotated and value is not AllServices
}


@pytest.fixture
def services() -> Services:
    parts: dict[str, Any] = {entry.name: Mock(spec=()) for entry in fields(Services)}
    return Services(**parts)


def test_nobody_else_looks_into_the_applications_state() -> None:
    looking = [
        str(file.relative_to(ROOM))
        for file in ROOM.rglob("*.py")
        if UNTYPED.search(file.read_text())
    ]
    assert looking == ["routers/dependencies.py"]


@pytest.mark.parametrize("name", GIVEN)
def test_each_dependency_is_what_its_type_says(name: str, services: Services) -> None:
    kind, depends = GIVEN[name]
    given = asyncio.run(depends.dependency(services))
    assert [given] == [
        getattr(services, entry.name) for entry in fields(Services) if TYPES[entry.name] is kind
    ]


@pytest.mark.parametrize("depends", [get_args(AllServices)[1], *(row[1] for row in GIVEN.values())])
def test_no_dependency_takes_a_thread(depends: Any) -> None:
    assert inspect.iscoroutinefunction(depends.dependency)


def test_a_connection_of_any_kind_leads_to_the_services(services: Services) -> None:
    application = FastAPI()
    keep_services(application, services)
    _, depends = get_args(AllServices)
    for kind in ("http", "websocket"):
        connection = HTTPConnection({"type": kind, "app": application})
        assert asyncio.run(depends.dependency(connection)) is services
