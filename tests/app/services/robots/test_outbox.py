import asyncio
from collections.abc import Coroutine
from typing import Any

from app.services.robots.outbox import ORDER_BYTES_PER_S, Outbox
from hardware.link.messages import HEARTBEAT_S, Cancel, Heartbeat, Stop, encode

HEARTBEAT = encode(Heartbeat())
STOP = Stop("1")


def run(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(test)


async def take(outbox: Outbox) -> str:
    """The next but heartbeats."""
    while (text := await outbox.take()) == HEARTBEAT:
        pass
    return text


def test_what_is_urgent_overtakes_an_order() -> None:
    async def test() -> None:
        outbox = Outbox()
        outbox.hand_over(["a", "b", "c"])
        assert await take(outbox) == "a"
        outbox.send(STOP)
        outbox.send(Cancel("x"))
        assert [await take(outbox) for _ in range(4)] == [
            encode(STOP), encode(Cancel("x")), "b", "c",
        ]  # fmt: skip

    run(test())


def test_a_waiting_reader_gets_what_comes() -> None:
    async def test() -> None:
        outbox = Outbox()
        assert await outbox.take() == HEARTBEAT
        waiting = asyncio.create_task(outbox.take())
        await asyncio.sleep(0)
        outbox.send(STOP)
        assert await waiting == encode(STOP)

    run(test())


def test_heartbeats_come_by_themselves_and_do_not_pile_up() -> None:
    async def test() -> None:
        loop, outbox = asyncio.get_running_loop(), Outbox()
        started = loop.time()
        assert [await outbox.take() for _ in range(3)] == [HEARTBEAT] * 3
        assert loop.time() - started >= 2 * HEARTBEAT_S * 0.99
        await asyncio.sleep(3 * HEARTBEAT_S)
        outbox.hand_over(["a"])
        assert [await outbox.take(), await outbox.take()] == [HEARTBEAT, "a"]

    run(test())


def test_only_what_was_not_taken_can_be_withdrawn() -> None:
    async def test() -> None:
        outbox = Outbox()
        outbox.hand_over(["a", "b"])
        assert await take(outbox) == "a"
        assert outbox.withdraw()
        assert not outbox.withdraw()
        outbox.hand_over(["c"])
        assert await take(outbox) == "c"
        assert not outbox.withdraw()

    run(test())


def test_orders_leave_no_faster_than_they_are_read() -> None:
    async def test() -> None:
        loop, outbox = asyncio.get_running_loop(), Outbox()
        part = "x" * (ORDER_BYTES_PER_S // 20)
        outbox.hand_over([part, part, "end"])
        started = loop.time()
        while await take(outbox) != "end":
            outbox.send(STOP)
            assert await take(outbox) == encode(STOP), "it did not go into the pause"
        assert loop.time() - started >= 0.1 * 0.99

    run(test())
