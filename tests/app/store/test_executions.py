from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import Engine

from app.store import ExecutionStore, RobotBusy
from app.store.executions import MOST_LISTED

NOON = datetime(2026, 5, 1, 12, tzinfo=UTC)


def identifier(number: int) -> str:
    return f"{number:032x}"


def add(store: ExecutionStore, number: int, robot: str = "tabletop") -> str:
    execution_id = identifier(number)
    store.add(
        execution_id, plan_id=identifier(0), robot=robot, status="queued",
        created_at=NOON + timedelta(seconds=number), document=f'{{"number":{number}}}',
    )  # fmt: skip
    return execution_id


def test_a_robot_has_one_active_execution(engine: Engine) -> None:
    store = ExecutionStore(engine)
    first = add(store, 1)
    with pytest.raises(RobotBusy) as raised:
        add(store, 2)
    assert raised.value.robot == "tabletop"
    assert store.document(identifier(2)) is None
    add(store, 3, "tabletop-sim")
    assert sorted(store.active()) == ['{"number":1}', '{"number":3}']
    store.save(first, status="executing", document="{}", ended=False)
    with pytest.raises(RobotBusy):
        add(store, 2)
    store.save(first, status="failed", document='{"ended":1}', ended=True)
    assert store.active() == ['{"number":3}']
    assert store.document(add(store, 2)) == '{"number":2}'
    assert store.document(first) == '{"ended":1}'
    # A late correction of one that has ended takes nothing from the robot's new one.
    store.save(first, status="failed", document='{"ended":2}', ended=True)
    with pytest.raises(RobotBusy):
        add(store, 4)


@pytest.mark.parametrize("text", ["", "1", "' OR 1=1", identifier(9), identifier(1).upper() + "A"])
def test_unknown_ids_are_none(engine: Engine, text: str) -> None:
    store = ExecutionStore(engine)
    add(store, 1)
    assert store.document(text) is None


def test_newest_come_first_and_not_all(engine: Engine) -> None:
    store = ExecutionStore(engine)
    for number in range(MOST_LISTED + 5):
        execution_id = add(store, number, "tabletop" if number % 2 else "tabletop-sim")
        store.save(execution_id, status="completed", document="{}", ended=True)
    rows = store.newest()
    assert [row.id for row in rows] == [identifier(54 - k) for k in range(MOST_LISTED)]
    assert rows[0].created_at == NOON + timedelta(seconds=54)
    assert rows[0].updated_at.tzinfo is UTC
    assert (rows[0].status, rows[0].plan_id) == ("completed", identifier(0))
    simulated = store.newest("tabletop-sim")
    assert len(simulated) == 28
    assert {row.robot for row in simulated} == {"tabletop-sim"}
    assert store.newest("nobody") == []
