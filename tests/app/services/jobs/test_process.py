import asyncio

import pytest

from app.observation.logs import LogOptions
from app.services.jobs.process import JobProcess
from app.services.solving.process import SolverLost


def test_a_process_that_was_ended_after_it_had_loaded_its_job_is_a_lost_one() -> None:
    async def work() -> None:
        process = JobProcess(LogOptions())
        await process.end()
        with pytest.raises(SolverLost):
            await process.part("0" * 32, 0, 0, None)

    asyncio.run(work())
