"""Executions from order to end, with a worker that has no arm."""

import concurrent.futures
from typing import Any

import pytest

from app.schemas.executions import ExecutionAnswer
from hardware.link.messages import (
    Cancel,
    Execute,
    ExecutionAccount,
    Pause,
    Resume,
    TargetAccount,
    TargetMotion,
)
from tests.app.conftest import Server
from tests.app.execution_requests import (
    assert_code,
    command,
    get,
    large_plan,
    make_plan,
    post,
    start,
    tamper,
    wait_for_status,
)
from tests.app.fake_worker import FakeWorker, worker

Body = dict[str, Any]


@pytest.fixture(scope="module")
def plan(server: Server) -> Body:
    return make_plan(server)


def finish(server: Server, fake: FakeWorker, execution: Body) -> None:
    fake.account(execution["id"], "completed")
    wait_for_status(server, execution, "completed")


def test_an_execution_from_order_to_end(server: Server) -> None:
    plan = make_plan(server, far=True)
    with worker(server) as fake:
        execution = start(server, plan)
        assert set(execution) == {
            "id", "plan_id", "robot", "simulated", "status", "created_at", "targets",
        }  # fmt: skip
        assert execution["simulated"] is True
        assert [target["target_id"] for target in execution["targets"]] == [
            "1", "far", "2", "3", "4", "5",
        ]  # fmt: skip
        assert execution["targets"][1]["status"] == "skipped"
        assert execution["targets"][1]["error"]["code"] == "out_of_reach"

        execute, motions = fake.order()
        assert execute.execution_id == execution["id"]
        assert (execute.plan_id, execute.tool) == (plan["id"], "laser")
        assert execute.model_version == plan["model_version"]
        assert list(execute.start_joints) == plan["start_joints"]
        planned = [entry for entry in plan["approaches"] if entry["status"] == "planned"]
        assert [motion.target_id for motion in motions] == list("12345")
        assert [motion.index for motion in motions] == list(range(5))
        for motion, entry in zip(motions, planned, strict=True):
            assert motion.execution_id == execution["id"]
            assert list(motion.times_s) == entry["trajectory"]["times_s"]
            assert [list(row) for row in motion.joints] == entry["trajectory"]["joints"]
            assert list(motion.standby_joints) == entry["standby_joints"]
            assert list(motion.thinning_joints) == entry["thinning_joints"]
            assert [part.name for part in motion.segments] == [
                "transfer", "cut_in", "dwell", "retreat",
            ]  # fmt: skip
        assert get(server, execution) == execution

        first = TargetAccount("1", "executing")
        fake.say(ExecutionAccount(execution["id"], "executing", (first,), segment="transfer"))
        running = wait_for_status(server, execution, "executing")
        assert running["segment"] == "transfer"
        assert running["started_at"] >= running["created_at"]
        assert running["targets"][0]["status"] == "executing"

        done = TargetAccount("1", "done", (0.1,) * 6, (0.2,) * 6, 0.001, 0.002)
        fake.say(ExecutionAccount(execution["id"], "completed", (done,)))
        over = wait_for_status(server, execution, "completed")
        assert over["targets"][0] == {
            "target_id": "1", "status": "done", "standby_error_m": 0.001, "target_error_m": 0.002,
            "measured_standby_joints": [0.1] * 6, "measured_thinning_joints": [0.2] * 6,
        }  # fmt: skip
        assert over["ended_at"] >= over["started_at"]
        assert "segment" not in over
        assert set(over) < set(ExecutionAnswer.model_fields)

        # What has ended stays as it is, and leaves the robot free.
        fake.account(execution["id"], "failed", **{"1": "unknown"})
        finish(server, fake, start(server, plan))
        assert get(server, execution) == over


def test_a_plan_of_more_than_fifty_targets_executes(server: Server) -> None:
    plan = make_plan(server, copies=11)
    assert "trajectory" not in plan["approaches"][0]
    with worker(server) as fake:
        execution = start(server, plan)
        _, motions = fake.order()
        assert [motion.target_id for motion in motions] == [
            entry["target_id"] for entry in plan["approaches"]
        ]
        assert_continuous(plan, motions)
        finish(server, fake, execution)


def test_order_independent_is_one_continuous_motion(server: Server) -> None:
    plan = make_plan(server, order="independent")
    second = plan["approaches"][1]["trajectory"]["joints"][0]
    assert second == plan["start_joints"]
    with worker(server) as fake:
        execution = start(server, plan)
        _, motions = fake.order()
        assert_continuous(plan, motions)
        finish(server, fake, execution)


def assert_continuous(plan: Body, motions: list[TargetMotion]) -> None:
    assert motions
    before = plan["start_joints"]
    for motion in motions:
        assert list(motion.joints[0]) == before
        assert motion.joints[-1] == pytest.approx(motion.standby_joints, abs=1e-9)
        before = list(motion.standby_joints)


def test_a_plan_is_executed_on_every_robot_of_its_model(server: Server, plan: Body) -> None:
    with worker(server, "tabletop", simulated=False) as fake:
        execution = start(server, plan, "tabletop")
        assert execution["simulated"] is False
        fake.order()
        finish(server, fake, execution)
    twin = server.client.post(
        "/v1/plans",
        json={
            "robot": "tabletop-sim",
            "targets": [
                {"id": "1", "position_m": [0.185, -0.057, 0.42], "branch_direction": [-1, -1, 1]}
            ],
        },
    ).json()
    assert (twin["robot"], twin["summary"]["planned"]) == ("tabletop-sim", 1)
    with worker(server) as fake:
        execution = start(server, twin)
        fake.order()
        finish(server, fake, execution)


def test_of_simultaneous_orders_one_is_taken(server: Server, plan: Body) -> None:
    with worker(server) as fake, concurrent.futures.ThreadPoolExecutor(8) as executor:
        answers = list(executor.map(lambda _: post(server, plan), range(8)))
        assert sorted(answer.status_code for answer in answers) == [202, *[409] * 7]
        for answer in answers:
            if answer.status_code == 409:
                assert_code(answer, 409, "busy")
        (taken,) = (answer.json() for answer in answers if answer.status_code == 202)
        execute, _ = fake.order()
        assert execute.execution_id == taken["id"]
        finish(server, fake, taken)


def test_a_plan_that_does_not_hold_any_more_is_not_sent(server: Server) -> None:
    plan = make_plan(server)
    approaches = [dict(entry) for entry in plan["approaches"]]
    approaches[2]["approach_angle_rad"] += 1e-4
    tamper(server, plan, approaches=approaches)
    unreadable = make_plan(server)
    tamper(server, unreadable, options={**unreadable["options"], "method": "forgotten"})
    with worker(server) as fake:
        for spoiled in (plan, unreadable):
            execution = start(server, spoiled)
            over = wait_for_status(server, execution, "failed")
            assert over["error"]["code"] == "plan_outdated"
            assert "started_at" not in over
        good = start(server, make_plan(server))
        assert fake.order()[0].execution_id == good["id"]
        finish(server, fake, good)


def test_pause_resume_and_cancel_while_executing(server: Server, plan: Body) -> None:
    with worker(server) as fake:
        execution = start(server, plan)
        fake.order()
        for name in ("pause", "resume"):
            assert_code(command(server, execution, name), 409, "wrong_state")
        fake.account(execution["id"], "executing", **{"1": "executing"})
        wait_for_status(server, execution, "executing")
        assert_code(command(server, execution, "resume"), 409, "wrong_state")
        answer = command(server, execution, "pause")
        assert (answer.status_code, answer.json()["status"]) == (202, "executing")
        assert fake.expect(Pause) == Pause(execution["id"])
        fake.account(execution["id"], "paused", **{"1": "executing"})
        wait_for_status(server, execution, "paused")
        assert_code(command(server, execution, "pause"), 409, "wrong_state")
        assert command(server, execution, "resume").status_code == 202
        assert fake.expect(Resume) == Resume(execution["id"])
        fake.account(execution["id"], "executing", **{"1": "executing"})
        wait_for_status(server, execution, "executing")
        answer = command(server, execution, "cancel")
        assert (answer.status_code, answer.json()["status"]) == (202, "executing")
        assert fake.expect(Cancel) == Cancel(execution["id"])
        fake.account(execution["id"], "canceled", **{"1": "executing", "2": "not_started"})
        over = wait_for_status(server, execution, "canceled")
        assert [target["status"] for target in over["targets"]] == [
            "unknown", *["not_started"] * 4,
        ]  # fmt: skip
        for name in ("pause", "resume", "cancel"):
            assert_code(command(server, execution, name), 409, "wrong_state")


def test_cancel_before_anything_was_sent(server: Server, plan: Body) -> None:
    large = large_plan(server)
    with worker(server) as fake:
        execution = start(server, large)
        answer = command(server, execution, "cancel")
        assert answer.status_code == 202
        assert answer.json()["status"] == "canceled"
        assert get(server, execution) == answer.json()
        assert "error" not in answer.json()
        following = start(server, plan)
        assert fake.order()[0].execution_id == following["id"]
        finish(server, fake, following)
        # By the time that another one of its size is ready, it would have been too.
        another = start(server, large)
        assert fake.expect(Execute).execution_id == another["id"]
        command(server, another, "cancel")
        wait_for_status(server, another, "canceled")


def test_cancel_while_motions_are_sent(server: Server, plan: Body) -> None:
    large = large_plan(server)
    with worker(server) as fake:
        execution = start(server, large)
        assert fake.expect(Execute).target_count == len(large["approaches"])
        assert command(server, execution, "cancel").json()["status"] == "canceled"
        received = 0
        while isinstance(message := fake.next(), TargetMotion):
            received += 1
        assert message == Cancel(execution["id"])
        assert received < len(large["approaches"])
        following = start(server, plan)
        assert fake.order()[0].execution_id == following["id"]
        finish(server, fake, following)


def test_cancel_of_an_order_that_may_have_begun_waits_for_the_worker(
    server: Server, plan: Body
) -> None:
    with worker(server) as fake:
        execution = start(server, plan)
        fake.order()
        assert command(server, execution, "cancel").json()["status"] == "queued"
        assert fake.expect(Cancel) == Cancel(execution["id"])
        assert_code(post(server, plan), 409, "busy")
        fake.account(execution["id"], "canceled")
        wait_for_status(server, execution, "canceled")


def test_list_has_the_newest_first(server: Server, plan: Body) -> None:
    with worker(server) as fake:
        started = [start(server, plan)]
        fake.order()
        finish(server, fake, started[0])
        started.append(start(server, plan))
        fake.order()
        listed = server.client.get("/v1/executions", params={"robot": "tabletop-sim"}).json()
        newest, older = listed["executions"][:2]
        assert [newest["id"], older["id"]] == [started[1]["id"], started[0]["id"]]
        assert newest["created_at"] == started[1]["created_at"]
        assert (newest["status"], older["status"]) == ("queued", "completed")
        assert set(newest) == {"id", "plan_id", "robot", "status", "created_at", "updated_at"}
        finish(server, fake, started[1])
    everywhere = server.client.get("/v1/executions").json()["executions"]
    assert {"tabletop", "tabletop-sim"} >= {entry["robot"] for entry in everywhere}
    assert server.client.get("/v1/executions?robot=nobody").json() == {"executions": []}
