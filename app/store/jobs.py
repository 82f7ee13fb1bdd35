"""The tables of jobs and of the parts that their plans are made of."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import ColumnElement, Connection, Engine, func, insert, select, update

from app.store.database import writing
from app.store.idempotency import NewEntry, insert_key
from app.store.instants import utc
from app.store.plans import ID
from app.store.tables import JOB_TEXTS, JOBS, PLAN_PARTS, PLANS

QUEUED, RUNNING, COMPLETED, FAILED, CANCELED = (
    "queued", "running", "completed", "failed", "canceled",
)  # fmt: skip
REQUEST, CHOICE = "request", "choice"
MOST_LISTED = 50


class JobEnded(Exception):
    """The job is not active any more; nothing was stored."""


@dataclass(frozen=True)
class JobRow:
    """A job as it stands. `done`, `planned` and `infeasible` count targets; times are in UTC."""

    id: str
    robot: str
    status: str
    active: bool
    targets: int
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    detail: str | None
    planned: int
    infeasible: int
    total_effort: float
    elapsed_s: float

    @property
    def done(self) -> int:
        """Targets that are finished."""
        return self.planned + self.infeasible


@dataclass(frozen=True)
class JobWork:
    """What it takes to go on with a job: its request, and what was decided and solved so far."""

    request: str
    choice: str | None
    parts: int
    done: int
    reference: str | None


@dataclass(frozen=True)
class NewPart:
    """A part that was solved. `reference` and `approaches` are JSON; see the table."""

    number: int
    first: int
    planned: int
    infeasible: int
    total_effort: float
    elapsed_s: float
    reference: str
    approaches: str


class JobStore:
    """Jobs. Its calls block: keep them off the event loop. What was written is durable.

    Parts are written once and never changed: a job that has ended keeps what it has.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(
        self,
        job_id: str,
        *,
        robot: str,
        targets: int,
        request: str,
        entry: Callable[[JobRow], NewEntry | None] = lambda _: None,
    ) -> JobRow:
        """Store a new job, queued, with the key it was asked for under; the job.

        Args:
            job_id: its id.
            robot: whose plan it makes.
            targets: how many.
            request: JSON.
            entry: the key with the answer to the job, if there is a key.

        Raises:
            KeyTaken: something was created under the key before; nothing was stored.
        """
        created_at = datetime.now(UTC)
        row = {
            "id": job_id,
            "robot": robot,
            "status": QUEUED,
            "active": True,
            "targets": targets,
            "created_at": created_at,
        }
        job = JobRow(
            id=job_id,
            robot=robot,
            status=QUEUED,
            active=True,
            targets=targets,
            created_at=created_at,
            started_at=None,
            ended_at=None,
            detail=None,
            planned=0,
            infeasible=0,
            total_effort=0.0,
            elapsed_s=0.0,
        )
        with writing(self._engine) as connection:
            insert_key(connection, entry(job))
            connection.execute(insert(JOBS), row)
            _keep_text(connection, job_id, REQUEST, request)
        return job

    def start(self, job_id: str) -> None:
        """A queued job runs now; one that ran before keeps when it began.

        Raises:
            JobEnded: it is not active any more.
        """
        began = func.coalesce(JOBS.c.started_at, datetime.now(UTC))
        with writing(self._engine) as connection:
            _change(connection, job_id, status=RUNNING, started_at=began)

    def save_choice(self, job_id: str, choice: str) -> None:
        """Keep what the batch decided as one.

        Raises:
            JobEnded: the job is not active any more.
        """
        with writing(self._engine) as connection:
            _change(connection, job_id, active=True)
            _keep_text(connection, job_id, CHOICE, choice)

    def add_part(self, job_id: str, part: NewPart) -> None:
        """Keep a part.

        Raises:
            JobEnded: the job is not active any more.
        """
        with writing(self._engine) as connection:
            _change(connection, job_id, active=True)
            connection.execute(insert(PLAN_PARTS), {"plan_id": job_id, **vars(part)})

    def complete(self, job_id: str, *, robot: str, request: str, answer: str) -> None:
        """The job is done, and its plan is there: its answer without approaches, and the parts.

        Raises:
            JobEnded: it is not active any more.
        """
        now = datetime.now(UTC)
        plan = {
            "id": job_id,
            "created_at": now,
            "robot": robot,
            "request": request,
            "answer": answer,
            "in_parts": True,
        }
        with writing(self._engine) as connection:
            _change(connection, job_id, status=COMPLETED, active=False, ended_at=now)
            connection.execute(insert(PLANS), plan)

    def end(self, job_id: str, status: str, detail: str | None = None) -> None:
        """The job has ended otherwise.

        Raises:
            JobEnded: it had ended before.
        """
        with writing(self._engine) as connection:
            _change(
                connection, job_id, status=status, active=False, detail=detail,
                ended_at=datetime.now(UTC),
            )  # fmt: skip

    def job(self, job_id: str) -> JobRow | None:
        """The job of that id, or None."""
        if not ID.fullmatch(job_id):
            return None
        found = self._rows(JOBS.c.id == job_id)
        return found[0] if found else None

    def newest(self) -> list[JobRow]:
        """The newest ones, newest first."""
        return self._rows(None)

    def _rows(self, condition: ColumnElement[bool] | None) -> list[JobRow]:
        sums = [
            func.coalesce(func.sum(PLAN_PARTS.c[name]), 0).label(name)
            for name in ("planned", "infeasible", "total_effort", "elapsed_s")
        ]
        jobs = select(JOBS.c.id).order_by(JOBS.c.created_at.desc(), JOBS.c.id).limit(MOST_LISTED)
        columns = [JOBS.c[name] for name in JobRow.__dataclass_fields__ if name in JOBS.c]
        query = (
            select(*columns, *sums)
            .select_from(JOBS.outerjoin(PLAN_PARTS, PLAN_PARTS.c.plan_id == JOBS.c.id))
            .where(JOBS.c.id.in_(jobs) if condition is None else condition)
            .group_by(*columns)
            .order_by(JOBS.c.created_at.desc(), JOBS.c.id)
        )
        with self._engine.connect() as connection:
            rows = connection.execute(query).mappings().all()
        times = ("created_at", "started_at", "ended_at")
        return [JobRow(**{**row, **{name: utc(row[name]) for name in times}}) for row in rows]

    def active(self) -> Sequence[str]:
        """The ids of all that have not ended, oldest first."""
        query = select(JOBS.c.id).where(JOBS.c.active).order_by(JOBS.c.created_at, JOBS.c.id)
        with self._engine.connect() as connection:
            return connection.execute(query).scalars().all()

    def work(self, job_id: str) -> JobWork:
        """What it takes to go on with an active job.

        Raises:
            JobEnded: it is not active any more.
        """
        with self._engine.connect() as connection:
            texts = dict(
                connection.execute(
                    select(JOB_TEXTS.c.kind, JOB_TEXTS.c.text)
                    .join(JOBS, JOBS.c.id == JOB_TEXTS.c.job_id)
                    .where(JOBS.c.id == job_id, JOBS.c.active)
                ).all()
            )
            if not texts:
                raise JobEnded(job_id)
            parts = PLAN_PARTS.c
            count, done = connection.execute(
                select(func.count(), func.coalesce(func.sum(parts.planned + parts.infeasible), 0))
                .where(parts.plan_id == job_id)
            ).one()  # fmt: skip
            reference = connection.execute(
                select(parts.reference).where(parts.plan_id == job_id, parts.number == count - 1)
            ).scalar_one_or_none()
        return JobWork(texts[REQUEST], texts.get(CHOICE), count, done, reference)


def _change(connection: Connection, job_id: str, **values: object) -> None:
    changed = connection.execute(
        update(JOBS).where(JOBS.c.id == job_id, JOBS.c.active).values(**values)
    )
    if changed.rowcount != 1:
        raise JobEnded(job_id)


def _keep_text(connection: Connection, job_id: str, kind: str, text: str) -> None:
    connection.execute(insert(JOB_TEXTS), {"job_id": job_id, "kind": kind, "text": text})
