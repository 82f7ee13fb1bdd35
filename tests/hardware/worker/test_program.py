"""A worker put together from its options: what is opened, told, refused, and closed again."""

import logging
import signal
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from hardware.end_effector.end_effectors import NoEndEffector
from hardware.exceptions import InvalidArm, ServoMissing
from hardware.link.messages import Hello
from hardware.link.worker_end import LinkRefused
from hardware.options import BadOption
from hardware.servos.control_tables import SIMULATED_FIRMWARE
from hardware.worker import program
from hardware.worker.program import NotSimulated, WorkerOptions, run_worker
from tests.hardware.parts import Bench, InProcessBus, make_bench

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OPTIONS = WorkerOptions(
    url="http://orchard:8000",
    robot="tabletop",
    port="/dev/servos",
    tool=None,
    end_effector="none",
    end_effector_record=None,
    calibration=None,
    data_dir=Path("absent"),
    baud_rate=57600,
    time_factor=1.0,
    version="1.2.3",
    token="prunus_a_b",
)


@dataclass
class Stage:
    """What the program puts together, and what its worker does when it runs."""

    folder: Path
    bench: Bench
    act: Callable[[], None] = lambda: None
    opened: list[tuple[str, int]] = field(default_factory=list)
    closed: list[str] = field(default_factory=list)
    links: list[tuple[str, Hello, object, str]] = field(default_factory=list)
    parts: tuple[object, ...] = ()
    records: list[Path | None] = field(default_factory=list)
    ended: int = 0
    said: list[str] = field(default_factory=list)

    def run(self, **changes: object) -> None:
        options = replace(OPTIONS, data_dir=self.folder, **changes)  # type: ignore[arg-type]
        run_worker(options, self.said.append)


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Stage]:
    it = Stage(tmp_path / "data", make_bench(noise_ticks=0))

    class Bus(InProcessBus):
        def close(self) -> None:
            it.closed.append("bus")

    class Laser(NoEndEffector):
        def close(self) -> None:
            it.closed.append("laser")

    class Worker:
        def __init__(self, *parts: object) -> None:
            it.parts = parts

        def run(self) -> None:
            it.act()

        def end(self) -> None:
            it.ended += 1

    def open_bus(port: str, baud_rate: int) -> Bus:
        it.opened.append((port, baud_rate))
        return Bus(it.bench.bus.simulated, device=f"real {port}")

    def laser(record: Path | None) -> Laser:
        it.records.append(record)
        return Laser()

    def link(url: str, hello: Hello, say: object, token: str) -> str:
        it.links.append((url, hello, say, token))
        return "the link"

    monkeypatch.setattr(program, "DynamixelBus", open_bus)
    monkeypatch.setattr(program, "RobotLink", link)
    monkeypatch.setattr(program, "Worker", Worker)
    monkeypatch.setattr(program, "END_EFFECTORS", {"none": laser, "laser": laser})
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield it
    for number, handler in before.items():
        signal.signal(number, handler)


def make_real(bench: Bench, *servo_ids: int) -> None:
    for servo_id in servo_ids:
        bench.servo(servo_id).table["firmware_version"] = SIMULATED_FIRMWARE - 1


def test_the_service_is_told_what_stands_here(stage: Stage) -> None:
    stage.run()
    ((url, hello, say, token),) = stage.links
    assert url == "ws://orchard:8000/v1/robots/tabletop/link"
    assert hello == Hello(
        robot="tabletop",
        model_version=stage.bench.robot.version,
        tool="laser",
        end_effector="none",
        device="real /dev/servos",
        simulated=True,
        calibration_rad=(0.0,) * 6,
        version="1.2.3",
    )
    assert token == "prunus_a_b"
    assert say == stage.said.append
    assert stage.opened == [("/dev/servos", 57600)]


def test_a_worker_gets_its_parts(stage: Stage) -> None:
    stage.run(tool="scaffold", end_effector="laser", end_effector_record=Path("record"))
    arm, tool, end_effector, link, journal, clock = stage.parts
    assert arm.map == stage.bench.map  # type: ignore[attr-defined]
    assert arm.clock is clock  # type: ignore[attr-defined]
    assert tool.name == "scaffold"  # type: ignore[attr-defined]
    assert end_effector.state == "none"  # type: ignore[attr-defined]
    assert link == "the link"
    assert stage.records == [Path("record")]
    assert stage.links[0][1].tool == "scaffold"
    journal.start("e1")  # type: ignore[attr-defined]
    assert "e1" in (stage.folder / "tabletop.journal").read_text()


def test_the_journal_is_that_of_the_robots_own_name(stage: Stage) -> None:
    stage.run(robot="tabletop-sim")
    assert [file.name for file in stage.folder.iterdir()] == ["tabletop-sim.journal"]
    assert stage.links[0][1].robot == "tabletop-sim"


def test_offsets_come_from_the_file_that_is_given(stage: Stage, tmp_path: Path) -> None:
    file = tmp_path / "calibration.toml"
    rows = "".join(f"joint_{k} = {k}\n" for k in range(1, 7))
    file.write_text(f'robot = "tabletop"\n[offset_deg]\n{rows}')
    stage.run(calibration=file)
    offsets = np.radians([1, 2, 3, 4, 5, 6])
    assert stage.links[0][1].calibration_rad == pytest.approx(offsets)
    with pytest.raises(InvalidArm):
        stage.run(calibration=tmp_path / "absent.toml")


# --- The end --------------------------------------------------------------------------------------
@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_the_worker(stage: Stage, number: int) -> None:
    stage.act = lambda: signal.raise_signal(number)
    stage.run()
    assert stage.ended == 1


def test_the_end_effector_is_closed_before_the_bus(stage: Stage) -> None:
    stage.act = lambda: stage.closed.append("ran")
    stage.run()
    assert stage.closed == ["ran", "laser", "bus"]


def test_what_was_opened_is_closed_when_the_service_refuses(stage: Stage) -> None:
    def refuse() -> None:
        raise LinkRefused("another model")

    stage.act = refuse
    with pytest.raises(LinkRefused):
        stage.run()
    assert stage.closed == ["laser", "bus"]
    assert stage.said == []


@pytest.mark.parametrize("held", [True, False])
def test_it_says_in_the_end_whether_the_arm_is_held(stage: Stage, held: bool) -> None:
    def act() -> None:
        arm = stage.parts[0]
        arm.check()  # type: ignore[attr-defined]
        if held:
            arm.enable_torque()  # type: ignore[attr-defined]

    stage.act = act
    stage.run()
    expected = "ended; torque is on: the arm holds" if held else "ended; torque is off"
    assert stage.said == [expected]


# --- What is refused ------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"end_effector": "saw"},
            "--end-effector saw is unknown; known: none, laser",
        ),
        ({"time_factor": 0.0}, "--time-factor is between"),
        ({"time_factor": float("nan")}, "--time-factor is between"),
        ({"tool": "saw"}, "--tool saw is unknown; known: laser, scaffold"),
    ],
)
def test_options_that_make_no_sense_are_refused_before_anything_is_opened(
    stage: Stage, changes: dict[str, object], said: str
) -> None:
    with pytest.raises(BadOption, match=said):
        stage.run(**changes)
    assert (stage.opened, stage.links, stage.records) == ([], [], [])


@pytest.mark.parametrize("real", [(61,), (11, 21, 22, 31, 32, 41, 51, 61)])
def test_a_simulated_robot_has_no_real_servos(stage: Stage, real: tuple[int, ...]) -> None:
    make_real(stage.bench, *real)
    with pytest.raises(NotSimulated, match=r"not all servos on /dev/servos are$"):
        stage.run(robot="tabletop-sim")
    assert stage.links == []
    assert stage.closed == ["bus"]


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_real_servos_keep_the_clocks_time(stage: Stage, factor: float) -> None:
    stage.run(time_factor=factor)
    assert stage.parts[5].factor == factor  # type: ignore[attr-defined]
    make_real(stage.bench, 61)
    with pytest.raises(NotSimulated, match="only simulated servos"):
        stage.run(time_factor=factor)
    stage.run()
    assert stage.parts[5].factor == 1.0  # type: ignore[attr-defined]
    assert not stage.links[-1][1].simulated


def test_without_a_folder_for_its_journal_it_does_not_begin(stage: Stage) -> None:
    stage.folder.write_text("")
    with pytest.raises(OSError, match="data"):
        stage.run()
    assert stage.closed == ["bus"]
    assert stage.links == []


def test_silent_servos_are_no_reason_not_to_begin(stage: Stage) -> None:
    """The worker tells of them: the service shall know."""
    stage.bench.fault("silent")
    stage.run()
    assert not stage.links[0][1].simulated
    with pytest.raises(ServoMissing):
        stage.parts[0].check()  # type: ignore[attr-defined]


# --- What is shown --------------------------------------------------------------------------------
def test_the_token_is_never_shown() -> None:
    assert "prunus_a_b" not in repr(OPTIONS)
    assert "orchard" in repr(OPTIONS)


def test_its_log_goes_to_standard_error(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[dict[str, object]] = []
    monkeypatch.setattr(logging, "basicConfig", lambda **options: given.append(options))
    stage.run()
    (options,) = given
    assert options["stream"] is sys.stderr
    record = logging.LogRecord("name", logging.ERROR, "", 0, "it stopped", (), None)
    assert logging.Formatter(str(options["format"])).format(record) == "ERROR it stopped"
