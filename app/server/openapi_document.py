"""The OpenAPI document: FastAPI's, and what is true beyond what it sees."""

from typing import Any, Final

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic.json_schema import models_json_schema

from app.routers.problem_answers import problem_answers
from app.schemas.comparisons import ComparisonRequest
from app.schemas.executions import ExecutionRequest
from app.schemas.frames import FrameRegistrationRequest, FrameRequest
from app.schemas.leases import LeaseRenewal, LeaseRequest
from app.schemas.problem_details import ProblemDetails
from app.schemas.requests import PlanRequest
from app.schemas.thinning_selections import ThinningSelectionRequest
from app.server.access_document import describe_access

PATH_PARAMETERS: Final = {
    "plan_id": "the plan's id, as Location or the plan has it",
    "job_id": "the job's id, as Location or the job has it",
    "execution_id": "the execution's id, as Location or the execution has it",
    "comparison_id": "the comparison's id, as Location or the comparison has it",
    "lease_id": "the lease's id, which only its holder knows",
    "name": "the robot's name, one of GET /v1/robots",
}


def openapi_document(app: FastAPI) -> dict[str, Any]:
    """What a client is told, made anew each time."""
    document = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes
    )
    # Bodies are parsed by hand, for strictness and for the problem form; so they are added here.
    for model, mode in (
        (PlanRequest, "validation"),
        (ExecutionRequest, "validation"),
        (ComparisonRequest, "validation"),
        (ThinningSelectionRequest, "validation"),
        (FrameRequest, "validation"),
        (FrameRegistrationRequest, "validation"),
        (LeaseRequest, "validation"),
        (LeaseRenewal, "validation"),
        (ProblemDetails, "serialization"),
    ):
        _, definitions = models_json_schema(
            [(model, mode)],  # type: ignore[list-item]
            ref_template="#/components/schemas/{model}",
        )
        document["components"]["schemas"].update(definitions["$defs"])
    refused = problem_answers(403)  # by the guard in front of every route
    failed = problem_answers(503, 507)  # by the database, behind almost all
    for route, path in document["paths"].items():
        for operation in path.values():
            if route.startswith("/v1/"):
                missing = failed.keys() - {int(code) for code in operation["responses"]}
                operation["responses"] |= {str(code): failed[code] for code in sorted(missing)}
            # FastAPI's own form of a validation error, which is never sent.
            _drop_stock_validation_error(operation["responses"])
            for parameter in operation.get("parameters", ()):
                if parameter["name"] in PATH_PARAMETERS:
                    parameter.setdefault("description", PATH_PARAMETERS[parameter["name"]])
            operation["responses"] |= {str(code): what for code, what in refused.items()}
    describe_access(document)
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)
    return document


def _drop_stock_validation_error(responses: dict[str, Any]) -> None:
    content = responses.get("422", {}).get("content", {})
    if "application/json" in content:
        del responses["422"]
