"""What the fuzzer is told of this service; that it finds is tried in tests/app/live."""

from pathlib import Path

import orjson
from schemathesis import openapi
from schemathesis.config import SchemathesisConfig
from schemathesis.core.result import Ok

from bench.service.fuzz import PHASES, fuzz_config

_DESCRIPTION = Path(__file__).parents[3] / "openapi" / "openapi.json"


def test_a_job_that_was_cancelled_may_be_read_and_a_deleted_frame_may_not() -> None:
    config = SchemathesisConfig.from_dict(fuzz_config(1, 1, PHASES))
    schema = openapi.from_dict(orjson.loads(_DESCRIPTION.read_bytes()), config=config)
    operations = [found.ok() for found in schema.get_all_operations() if isinstance(found, Ok)]
    left_out = {
        operation.path
        for operation in operations
        if not schema.config.checks_config_for(
            operation=operation, phase="stateful"
        ).use_after_free.enabled
    }
    assert left_out == {found.path for found in operations if found.path.startswith("/v1/jobs")}
    assert left_out < {found.path for found in operations}
