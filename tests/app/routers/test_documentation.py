"""`/docs` works on a machine without internet."""

import json
import re
from typing import Any

import jsonschema_rs
import pytest

from app.schemas.examples import EXAMPLES
from tests.app.conftest import REPOSITORY, Server


def test_page_loads_only_from_the_service(server: Server) -> None:
    page = server.client.get("/docs")
    assert page.status_code == 200
    assert page.headers["content-type"].startswith("text/html")
    loaded = re.findall(r"""(?:src|href)=["']([^"']+)["']|url: ["']([^"']+)["']""", page.text)
    addresses = [first or second for first, second in loaded]
    assert len(addresses) == 4
    assert "/openapi.json" in addresses
    for address in addresses:
        assert address.startswith("/")
        assert not address.startswith("//")
        answer = server.client.get(address)
        assert answer.status_code == 200
        assert answer.content
    assert "://" not in page.text
    assert '"validatorUrl": null' in page.text


def test_style_loads_nothing_more(server: Server) -> None:
    style = server.client.get("/docs/files/swagger-ui.css").text
    assert "@import" not in style
    for address in re.findall(r"url\(\s*[\"']?([^\"')]{5})", style):
        assert address == "data:", address


def test_no_other_page_is_there(server: Server) -> None:
    assert server.client.get("/redoc").status_code == 404
    assert server.client.get("/docs/files/%2e%2e/core.py").status_code == 404


def test_every_body_has_an_example_that_is_answered_as_described(server: Server) -> None:
    document = server.client.get("/openapi.json").json()
    plan = server.client.post("/v1/plans", json=EXAMPLES["PlanRequest"])
    known = {"plan_id": plan.json()["id"], "name": "tabletop-sim"}
    sent = []
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            if "requestBody" not in operation:
                continue
            body = operation["requestBody"]["content"]["application/json"]["example"]
            if "plan_id" in body:
                body |= {"plan_id": known["plan_id"]}
            answer = server.client.request(method, path.format_map(known), json=body)
            expected = min(code for code in operation["responses"] if code.startswith("2"))
            if operation["operationId"] == "create_execution":
                expected = "503"  # there is no worker here
            assert answer.status_code in (int(expected), 201), (path, answer.text)
            if "lease_id" in (told := answer.json()):
                known["lease_id"] = told["lease_id"]
            (described,) = operation["responses"][str(answer.status_code)]["content"].values()
            wanted: dict[str, Any] = {**document, **described["schema"]}
            jsonschema_rs.validator_for(wanted).validate(told)
            sent.append(operation["operationId"])
    assert len(sent) == len(EXAMPLES)
    server.client.delete(f"/v1/robots/tabletop-sim/lease/{known['lease_id']}")
    server.client.delete("/v1/frames/tabletop-sim")


@pytest.mark.parametrize(
    ("file", "schema"),
    [
        ("data_set_3.json", "PlanRequest"),
        ("frame_registration.json", "FrameRegistrationRequest"),
        ("thinning_selection.json", "ThinningSelectionRequest"),
    ],
)
def test_examples_in_files_are_those_of_the_document(file: str, schema: str) -> None:
    text = (REPOSITORY / "openapi" / "examples" / file).read_text()
    assert json.loads(text) == EXAMPLES[schema]
