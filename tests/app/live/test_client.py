"""The client that the vision team generates, built and used against a live server."""

import importlib
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import httpx2
import jsonschema_rs
import pytest

from tests.app.conftest import REPOSITORY, Server, assert_problem
from tests.docs.test_documents import fences

EXAMPLES = REPOSITORY / "openapi" / "examples"
DOCUMENT = REPOSITORY / "openapi" / "openapi.json"
BIN = Path(sys.executable).parent
# What each example is the body of, and the answer to it.
BODIES = {
    "data_set_3.json": ("POST", "/v1/plans", 201, "PlanAnswer"),
    "frame_registration.json": (
        "POST", "/v1/frames/example/registration", 201, "FrameAnswer",
    ),
    "thinning_selection.json": ("POST", "/v1/thinning-selections", 200, "ThinningSelectionAnswer"),
}  # fmt: skip


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder that the generated client is in, as docs/client.md has it made."""
    folder = tmp_path_factory.mktemp("generated")
    (command,) = fences("docs/client.md", "sh")
    words = command.split()
    words[words.index("--output-path") + 1] = str(folder / "prunus_client")
    finished = subprocess.run(
        [BIN / words[0], *words[1:]],
        cwd=REPOSITORY,
        env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    told = finished.stdout + finished.stderr
    assert finished.returncode == 0, told
    assert "arning" not in told, told
    sys.path.insert(0, str(folder))
    yield folder
    sys.path.remove(str(folder))


@pytest.fixture
def client(package: Path, server: Server) -> Iterator[Any]:
    with module("client").Client(base_url=server.url) as client:
        yield client


def module(name: str) -> ModuleType:
    return importlib.import_module(f"prunus_client.{name}")


def test_plans_through_the_client(client: Any) -> None:
    models = module("models")
    create, get = module("api.plans.create_plan"), module("api.plans.get_plan")
    body = json.loads((EXAMPLES / "data_set_3.json").read_text())
    body["options"]["method"] = "ssas"
    body["targets"].append({**body["targets"][0], "id": "far", "position_m": [2.0, 0.0, 0.3]})
    request = models.PlanRequest.from_dict(body)
    plan = create.sync(client=client, body=request, idempotency_key="from-the-client")
    assert isinstance(plan, models.PlanAnswer)
    assert [entry.status for entry in plan.approaches] == ["planned"] * 5 + ["infeasible"]
    assert plan.approaches[-1].reason.code == "out_of_reach"
    again = create.sync_detailed(client=client, body=request, idempotency_key="from-the-client")
    assert again.parsed == plan
    assert again.headers["idempotency-replayed"] == "true"
    assert get.sync(plan.id, client=client) == plan
    missing = get.sync("0" * 32, client=client)
    assert isinstance(missing, models.ProblemDetails)
    assert missing.status == 404
    body["targets"][0]["position_m"] = [1000.0, 0.0, 0.0]
    refused = create.sync(client=client, body=models.PlanRequest.from_dict(body))
    assert isinstance(refused, models.ProblemDetails)
    assert refused.errors[0].pointer == "#/targets/0/position_m"


def test_jobs_robots_and_selections_through_the_client(client: Any) -> None:
    models = module("models")
    request = models.PlanRequest.from_dict(json.loads((EXAMPLES / "data_set_3.json").read_text()))
    create = module("api.plans.create_plan")
    job = create.sync(client=client, body=request, prefer="respond-async")
    assert isinstance(job, models.JobAnswer)
    assert module("api.jobs.get_job").sync(job.id, client=client).targets == 5
    robots = module("api.robots.list_robots").sync(client=client)
    assert "tabletop" in [robot.name for robot in robots.robots]
    selection = models.ThinningSelectionRequest.from_dict(
        json.loads((EXAMPLES / "thinning_selection.json").read_text())
    )
    chosen = module("api.thinning_selections.create_thinning_selection").sync(
        client=client, body=selection
    )
    assert [target.id for target in chosen.targets] == ["1", "4"]


def test_what_is_new_breaks_nothing(package: Path, server: Server) -> None:
    body = json.loads((EXAMPLES / "data_set_3.json").read_text())
    answer = server.client.post("/v1/plans", json=body).json()
    answer["weather"] = {"wind_m_s": 3.0}
    answer["approaches"][0] |= {"status": "postponed", "because": "rain"}
    plan = module("models").PlanAnswer.from_dict(answer)
    assert plan.approaches[0].status == "postponed"
    assert plan.approaches[1].status == "planned"


@pytest.mark.parametrize("name", BODIES)
def test_examples_are_answered_as_described(server: Server, name: str) -> None:
    method, path, status, schema = BODIES[name]
    answer = server.client.request(
        method, path, content=(EXAMPLES / name).read_bytes(),
        headers={"Content-Type": "application/json"},
    )  # fmt: skip
    assert answer.status_code == status, answer.text
    document = json.loads(DOCUMENT.read_text())
    wanted: dict[str, Any] = {**document, "$ref": f"#/components/schemas/{schema}"}
    jsonschema_rs.validator_for(wanted).validate(answer.json())


def test_every_example_is_a_body_or_a_program() -> None:
    assert {file.name for file in EXAMPLES.iterdir()} == {
        *BODIES,
        "first_ten_lines.py",
        "first_ten_lines.sh",
    }


@pytest.mark.parametrize("kind", ["py", "sh"])
def test_first_ten_lines(package: Path, server: Server, kind: str) -> None:
    program = EXAMPLES / f"first_ten_lines.{kind}"
    lines = [line for line in program.read_text().splitlines() if line]
    assert len(lines) <= 10
    finished = subprocess.run(
        [sys.executable if kind == "py" else "sh", program],
        cwd=REPOSITORY,
        env={**os.environ, "PRUNUS_URL": server.url, "PYTHONPATH": str(package)},
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    if kind == "py":
        assert [line.split()[:2] for line in finished.stdout.splitlines()] == [
            [str(number), "planned"] for number in range(1, 6)
        ]
    else:
        assert json.loads(finished.stdout)["summary"]["planned"] == 5


def test_the_documents_ten_lines_are_the_examples() -> None:
    (shown,) = fences("docs/client.md", "python")
    assert shown.strip() == (EXAMPLES / "first_ten_lines.py").read_text().strip()


def test_the_document_is_one_for_generators() -> None:
    document = json.loads(DOCUMENT.read_text())

    def walk(value: object, path: str) -> None:
        if isinstance(value, dict):
            for forbidden in ("anyOf", "oneOf", "prefixItems", "enum", "const", "nullable"):
                assert forbidden not in value, path
            assert value.get("type") != "null", path
            for name, inner in value.items():
                walk(inner, f"{path}/{name}")
        elif isinstance(value, list):
            for index, inner in enumerate(value):
                walk(inner, f"{path}/{index}")

    walk(document["components"]["schemas"], "")
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            where = f"{method} {path}"
            assert operation["summary"], where
            assert operation["description"], where
            assert operation["tags"], where
            for parameter in operation.get("parameters", ()):
                assert parameter.get("description"), (where, parameter["name"])
            problems = [code for code in operation["responses"] if code >= "400"]
            assert problems, where
            if "requestBody" in operation:
                assert {"408", "413", "415", "422"} <= set(problems), where
            for code in problems:
                assert "application/problem+json" in operation["responses"][code]["content"], where


def test_documentation_needs_no_internet(server: Server) -> None:
    page = httpx2.get(f"{server.url}/docs", trust_env=False)
    assert page.status_code == 200
    assert "://" not in page.text.replace("http://www.w3.org", "")
    for path in ("/docs/files/swagger-ui-bundle.js", "/docs/files/swagger-ui.css", "/openapi.json"):
        assert path in page.text
        assert httpx2.get(f"{server.url}{path}", trust_env=False).status_code == 200
    assert_problem(httpx2.get(f"{server.url}/docs/files/nothing.js", trust_env=False), 404)
