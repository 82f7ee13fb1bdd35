"""Who may join, and what a link's end does to an execution."""

from typing import Any

import pytest

from hardware.link.messages import (
    SILENCE_S,
    Cancel,
    ExecutionAccount,
    Failure,
    Heartbeat,
    TargetAccount,
    Welcome,
    decode_from_service,
    encode,
)
from tests.app.conftest import Server
from tests.app.execution_requests import (
    executing,
    get,
    large_plan,
    make_plan,
    start,
    wait_for_status,
)
from tests.app.fake_worker import (
    AT,
    IDLE,
    MEASURED,
    closed,
    hello,
    link,
    state,
    wait_for,
    worker,
)

Body = dict[str, Any]


@pytest.fixture(scope="module")
def plan(server: Server) -> Body:
    return make_plan(server)


REFUSALS: dict[str, tuple[str, Any, int]] = {
    "unknown robot": ("nobody", hello(), 4404),
    "robot of another name": ("tabletop-sim", hello("tabletop"), 4400),
    "another version": ("tabletop-sim", hello(model_version="000000000000"), 4412),
    "servos of a simulated one": ("tabletop-sim", hello(simulated=False), 4412),
    "calibration of another arm": ("tabletop-sim", hello(calibration_rad=(0.0,)), 4400),
    "no hello first": ("tabletop-sim", IDLE, 4400),
    "no message": ("tabletop-sim", '{"type": "qq7z"}', 4400),
    "no JSON": ("tabletop-sim", "qq7z", 4400),
    "nothing in it": ("tabletop-sim", "", 4400),
    "bytes": ("tabletop-sim", b"\xff\xfe", 4400),
    "not finite": (
        "tabletop-sim", encode(hello()).replace("0.01", "1e999"), 4400,
    ),
    "unknown field": (
        "tabletop-sim", encode(hello()).replace("{", '{"qq7z": 1, ', 1), 4400,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_workers_that_may_not_join(server: Server, name: str) -> None:
    robot, first, code = REFUSALS[name]
    with link(server, robot) as connection:
        connection.send(first if isinstance(first, str | bytes) else encode(first))
        found, reason = closed(connection)
    assert found == code
    assert reason.endswith(".")
    assert "qq7z" not in reason
    assert state(server)["connected"] is False


def test_a_hello_that_does_not_come(server: Server) -> None:
    with link(server) as connection:
        assert closed(connection)[0] == 4408


def test_a_robot_has_one_worker(server: Server) -> None:
    with worker(server):
        for _ in range(2):
            with link(server) as second:
                second.send(encode(hello()))
                assert closed(second)[0] == 4409
        assert state(server)["connected"] is True
    with worker(server):
        assert state(server)["connected"] is True


def test_the_service_says_something_all_the_time(server: Server) -> None:
    with link(server) as connection:
        connection.send(encode(hello()))
        for wanted in (Welcome("tabletop-sim"), *[Heartbeat()] * 4):
            connection.send(encode(IDLE))
            assert decode_from_service(connection.recv(timeout=SILENCE_S)) == wanted
    wait_for(lambda: not state(server)["connected"])


@pytest.mark.parametrize(
    "message",
    [
        encode(hello()),
        encode(ExecutionAccount("0" * 32, "done", ())),
        '{"type": "telemetry", "status": "qq7z"}',
        "[" * 10_000,
        b"\x00" * 1000,
    ],
    ids=["second hello", "unknown status", "fields missing", "deep", "bytes"],
)
def test_what_is_no_message_ends_the_link(server: Server, plan: Body, message: Any) -> None:
    with worker(server) as fake:
        execution = executing(server, fake, plan)
        fake.connection.send(message)
        code, reason = closed(fake.connection)
        assert code == 4400
        assert "qq7z" not in reason
    over = wait_for_status(server, execution, "failed")
    assert over["error"]["code"] == "worker_lost"


def test_a_worker_that_leaves_fails_its_execution(server: Server, plan: Body) -> None:
    with worker(server) as fake:
        execution = executing(server, fake, plan)
    over = wait_for_status(server, execution, "failed")
    assert over["error"]["code"] == "worker_lost"
    assert over["error"]["detail"]
    assert over["ended_at"] >= over["started_at"]
    assert [target["status"] for target in over["targets"]] == ["unknown", *["not_started"] * 4]


def test_a_worker_that_falls_silent_fails_its_execution(server: Server, plan: Body) -> None:
    with worker(server) as fake:
        execution = executing(server, fake, plan)
        fake.silence()
        assert closed(fake.connection)[0] == 4408
        over = wait_for_status(server, execution, "failed")
        assert over["error"]["code"] == "link_lost"
        assert over["targets"][0]["status"] == "unknown"


def test_a_queued_execution_fails_with_its_link_and_is_not_sent_again(
    server: Server, plan: Body
) -> None:
    with worker(server):
        execution = start(server, large_plan(server))
    assert wait_for_status(server, execution, "failed")["error"]["code"] == "worker_lost"
    with worker(server) as fake:
        following = start(server, plan)
        assert fake.order()[0].execution_id == following["id"]
        fake.account(following["id"], "completed")
        wait_for_status(server, following, "completed")


def test_what_the_worker_says_last_counts(server: Server, plan: Body) -> None:
    with worker(server) as fake:
        execution = executing(server, fake, plan)
        fake.say(ExecutionAccount(execution["id"], "completed", (MEASURED,)))
        fake.connection.close()
    over = wait_for_status(server, execution, "completed")
    assert over["targets"][0]["target_error_m"] == 0.002


def test_a_late_account_corrects_the_targets_alone(server: Server, plan: Body) -> None:
    with worker(server) as fake:
        execution = executing(server, fake, plan)
    lost = wait_for_status(server, execution, "failed")
    failure = Failure("link_lost", "the service was not heard", AT)
    with worker(server) as fake:
        account = ExecutionAccount(
            execution["id"], "failed", (MEASURED, TargetAccount("2", "unknown")), error=failure
        )
        fake.say(account)
        wait_for(lambda: get(server, execution)["targets"][0]["status"] == "done")
        corrected = get(server, execution)
        assert corrected["targets"][0]["measured_thinning_joints"] == [0.2] * 6
        assert corrected["targets"][1]["status"] == "unknown"
        assert {**corrected, "targets": []} == {**lost, "targets": []}

        # One that is still moving has been given up here.
        fake.account(execution["id"], "executing", **{"1": "executing"})
        assert fake.expect(Cancel) == Cancel(execution["id"])
        fake.account("0" * 32, "executing")
        assert fake.expect(Cancel) == Cancel("0" * 32)
        assert get(server, execution)["targets"][0]["status"] == "unknown"

        # The robot's next execution is another matter.
        following = start(server, plan)
        fake.order()
        fake.say(account)
        fake.account(following["id"], "completed")
        wait_for_status(server, following, "completed")
        assert get(server, execution)["status"] == "failed"


def test_accounts_of_another_robot_are_ignored(server: Server, plan: Body) -> None:
    with worker(server) as fake, worker(server, "tabletop") as other:
        execution = executing(server, fake, plan)
        other.account(execution["id"], "completed", **{"1": "done"})
        other.account(execution["id"], "executing")
        assert other.expect(Cancel) == Cancel(execution["id"])
        assert get(server, execution) == execution
        fake.account(execution["id"], "completed")
        wait_for_status(server, execution, "completed")
