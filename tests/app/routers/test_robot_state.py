"""State, stop and acknowledge, with a worker that has no arm."""

import concurrent.futures
from dataclasses import asdict, replace
from typing import Any

import pytest

from app.schemas.executions import RobotStateAnswer
from hardware.link.messages import (
    Acknowledge,
    AcknowledgeReport,
    Cancel,
    Execute,
    Failure,
    Stop,
    StopReport,
    TargetMotion,
)
from tests.app.conftest import Server, assert_problem
from tests.app.execution_requests import get, large_plan, make_plan, post, start, wait_for_status
from tests.app.fake_worker import AT, IDLE, JOINTS, SERVO, FakeWorker, state, wait_for, worker

Body = dict[str, Any]
FAULT = Failure("servo_missing", "servo 11 does not answer", AT)


def ask(server: Server, name: str, robot: str = "tabletop-sim") -> Any:
    return server.client.post(f"/v1/robots/{robot}/{name}")


def answer_stop(fake: FakeWorker) -> None:
    stop = fake.expect(Stop)
    fake.say(StopReport(stop.request_id, True, True, "it stands", JOINTS, AT))


def test_state_without_a_worker(server: Server) -> None:
    assert state(server, "tabletop") == {
        "robot": "tabletop", "connected": False, "status": "disconnected", "simulated": False,
    }  # fmt: skip
    assert state(server)["simulated"] is True


def test_state_is_the_last_telemetry(server: Server) -> None:
    with worker(server) as fake:
        found = state(server)
        assert 0 <= found.pop("telemetry_age_s") < 2.0
        servo = asdict(SERVO)
        servo["errors"] = []
        assert found == {
            "robot": "tabletop-sim", "connected": True, "status": "idle", "simulated": True,
            "joints": list(JOINTS), "joints_read_at": AT, "tool": "laser",
            "end_effector": "simulated", "end_effector_state": "off", "torque": "on",
            "device": "/dev/none", "faults": [], "servos": [servo], "overruns": 3,
        }  # fmt: skip
        fake.telemetry = replace(
            IDLE, status="fault", joints=None, joints_read_at=None, faults=(FAULT,),
            execution_id="0" * 32,
        )  # fmt: skip
        wait_for(lambda: state(server)["status"] == "fault")
        found = state(server)
        assert found["faults"] == [asdict(FAULT)]
        assert found["execution_id"] == "0" * 32
        assert "joints" not in found
        assert set(found) <= set(RobotStateAnswer.model_fields)


@pytest.mark.parametrize("path", ["state", "stop", "acknowledge"])
def test_unknown_robots(server: Server, path: str) -> None:
    method = "GET" if path == "state" else "POST"
    answer = server.client.request(method, f"/v1/robots/qq7z/{path}")
    assert_problem(answer, 404)
    assert "qq7z" not in answer.text


def test_stop_and_acknowledge_need_a_worker(server: Server) -> None:
    problem = assert_problem(ask(server, "stop"), 503)
    assert problem["type"].endswith(":no_worker")
    assert "Nothing was stopped" in problem["detail"]
    assert assert_problem(ask(server, "acknowledge"), 503)["type"].endswith(":no_worker")


@pytest.mark.parametrize("status", ["idle", "executing", "paused", "fault"])
def test_stop_works_in_every_state(server: Server, status: str) -> None:
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(1) as executor:
        fake.telemetry = replace(IDLE, status=status)
        wait_for(lambda: state(server)["status"] == status)
        stopping = executor.submit(ask, server, "stop")
        answer_stop(fake)
        answer = stopping.result()
    assert answer.status_code == 200
    assert answer.json() == {
        "stopped": True, "verified": True, "joints": list(JOINTS), "joints_read_at": AT,
        "detail": "it stands",
    }  # fmt: skip


def test_stops_are_answered_each_with_its_own_report(server: Server) -> None:
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(3) as executor:
        stopping = [executor.submit(ask, server, "stop") for _ in range(3)]
        stops = [fake.expect(Stop) for _ in range(3)]
        fake.say(AcknowledgeReport("of nobody", ()))
        for stop in reversed(stops):
            fake.say(StopReport(stop.request_id, True, False, stop.request_id))
        details = {answer.result().json()["detail"] for answer in stopping}
    assert details == {stop.request_id for stop in stops}
    assert len(details) == 3


def test_a_stop_without_an_answer_says_so(server: Server) -> None:
    with worker(server) as fake:
        answer = ask(server, "stop")
        fake.expect(Stop)
        assert answer.status_code == 200
        assert (answer.json()["stopped"], answer.json()["verified"]) == (False, False)
        assert "not known" in answer.json()["detail"]
        fake.say(StopReport("of nobody", True, True, "too late"))
        assert assert_problem(ask(server, "acknowledge"), 503)["type"].endswith(":no_answer")


def test_a_stop_whose_worker_leaves_says_so(server: Server) -> None:
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(1) as executor:
        stopping = executor.submit(ask, server, "stop")
        fake.expect(Stop)
        fake.connection.close()
        assert stopping.result().json()["stopped"] is False


def test_acknowledge_answers_what_is_left(server: Server) -> None:
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(1) as executor:
        for left in ((FAULT,), ()):
            asking = executor.submit(ask, server, "acknowledge")
            request_id = fake.expect(Acknowledge).request_id
            fake.say(AcknowledgeReport(request_id, left))
            assert asking.result().json() == {"faults": [asdict(fault) for fault in left]}


def test_a_stop_overtakes_motions_and_keeps_the_order_from_beginning(server: Server) -> None:
    large = large_plan(server)
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(1) as executor:
        execution = start(server, large)
        fake.expect(Execute)
        fake.expect(TargetMotion)
        stopping = executor.submit(ask, server, "stop")
        received = 1
        while isinstance(message := fake.next(), TargetMotion):
            received += 1
        assert isinstance(message, Stop)
        assert received < len(large["approaches"])
        fake.say(StopReport(message.request_id, True, True, "it stands"))
        assert stopping.result().json()["stopped"] is True
        over = wait_for_status(server, execution, "failed")
        assert over["error"]["code"] == "stopped"
        assert {target["status"] for target in over["targets"]} == {"not_started"}
        following = start(server, make_plan(server))
        assert fake.order()[0].execution_id == following["id"]
        fake.account(following["id"], "completed")
        wait_for_status(server, following, "completed")


def test_a_stop_keeps_what_is_being_prepared_from_beginning(server: Server) -> None:
    large, plan = large_plan(server), make_plan(server)
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(1) as executor:
        execution = start(server, large)
        stopping = executor.submit(ask, server, "stop")
        answer_stop(fake)
        assert stopping.result().json()["stopped"] is True
        over = wait_for_status(server, execution, "failed")
        assert over["error"]["code"] == "stopped"
        following = start(server, plan)
        assert fake.order()[0].execution_id == following["id"]
        fake.account(following["id"], "completed")
        wait_for_status(server, following, "completed")


def test_a_stop_leaves_the_end_of_what_has_begun_to_the_worker(server: Server) -> None:
    plan = make_plan(server)
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(1) as executor:
        execution = start(server, plan)
        fake.order()
        fake.account(execution["id"], "executing", **{"1": "executing"})
        wait_for_status(server, execution, "executing")
        stopping = executor.submit(ask, server, "stop")
        answer_stop(fake)
        stopping.result()
        assert get(server, execution)["status"] == "executing"
        assert assert_problem(post(server, plan), 409)["type"].endswith(":busy")
        fake.account(execution["id"], "failed", **{"1": "unknown"})
        wait_for_status(server, execution, "failed")


def test_other_robots_do_not_wait(server: Server) -> None:
    """One worker does not read while it is sent much; the other is stopped all the same."""
    large = large_plan(server)
    with worker(server) as slow, worker(server, "tabletop") as fake:
        execution = start(server, large)
        slow.expect(Execute)
        with concurrent.futures.ThreadPoolExecutor(1) as executor:
            stopping = executor.submit(ask, server, "stop", "tabletop")
            answer_stop(fake)
            assert stopping.result().json()["stopped"] is True
        assert server.client.post(f"/v1/executions/{execution['id']}/cancel").status_code == 202
        while isinstance(message := slow.next(), TargetMotion):
            pass
        assert message == Cancel(execution["id"])
        slow.account(execution["id"], "canceled")
        wait_for_status(server, execution, "canceled")
