"""The tables; `migrations/` brings a database to them."""

from sqlalchemy import (
    Boolean,
    Column,
    DateTime,
    Float,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    false,
)

METADATA = MetaData()

# A plan that a job made has its approaches in PLAN_PARTS, not in its answer.
PLANS = Table(
    "plans",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("robot", String(200), nullable=False),
    Column("request", Text, nullable=False),
    Column("answer", Text, nullable=False),
    Column("in_parts", Boolean, nullable=False, server_default=false()),
)

# A job's id is its plan's. `choice` is what the batch as one decided, before any part was solved.
JOBS = Table(
    "jobs",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("robot", String(200), nullable=False),
    Column("status", String(32), nullable=False),
    Column("active", Boolean, nullable=False),
    Column("targets", Integer, nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("started_at", DateTime(timezone=True), nullable=True),
    Column("ended_at", DateTime(timezone=True), nullable=True),
    Column("detail", Text, nullable=True),
    Index("jobs_by_age", "created_at", "id"),
)

# `kind` is "request" or "choice", both JSON. They have megabytes, and SQLite would copy them with
# every change of the job's row.
JOB_TEXTS = Table(
    "job_texts",
    METADATA,
    Column("job_id", String(32), primary_key=True),
    Column("kind", String(16), primary_key=True),
    Column("text", Text, nullable=False),
)

# `first` is the place of a part's first target in execution order; `reference` the posture that
# the next part starts from, JSON; `approaches` a JSON array.
PLAN_PARTS = Table(
    "plan_parts",
    METADATA,
    Column("plan_id", String(32), primary_key=True),
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("first", Integer, nullable=False),
    Column("planned", Integer, nullable=False),
    Column("infeasible", Integer, nullable=False),
    Column("total_effort", Float, nullable=False),
    Column("elapsed_s", Float, nullable=False),
    Column("reference", Text, nullable=False),
    Column("approaches", Text, nullable=False),
)

# `active_robot` is the robot while the execution is active and NULL once it has ended: the
# database itself keeps a robot from having two.
EXECUTIONS = Table(
    "executions",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("plan_id", String(32), nullable=False),
    Column("robot", String(200), nullable=False),
    Column("status", String(32), nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("updated_at", DateTime(timezone=True), nullable=False),
    Column("active_robot", String(200), nullable=True, unique=True),
    Column("document", Text, nullable=False),
    Index("executions_by_age", "created_at", "id"),
)

COMPARISONS = Table(
    "comparisons",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("scenario", String(200), nullable=False),
    Column("active", Boolean, nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("updated_at", DateTime(timezone=True), nullable=False),
    Column("document", Text, nullable=False),
    Column("page", Text, nullable=True),
)

# What was created under a key, written together with it. `body` is NULL where `location` tells what
# to answer with.
IDEMPOTENCY_KEYS = Table(
    "idempotency_keys",
    METADATA,
    Column("scope", String(200), primary_key=True),
    Column("key", String(200), primary_key=True),
    Column("digest", String(64), nullable=False),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("status", Integer, nullable=False),
    Column("location", String(300), nullable=False),
    Column("body", Text, nullable=True),
)

FRAMES = Table(
    "frames",
    METADATA,
    Column("name", String(100), primary_key=True),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("updated_at", DateTime(timezone=True), nullable=False),
    Column("document", Text, nullable=False),
)

# Of a token only its digest is kept.
TOKENS = Table(
    "tokens",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("name", String(100), nullable=False),
    Column("scopes", String(200), nullable=False),
    Column("digest", String(64), nullable=False, unique=True),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("revoked_at", DateTime(timezone=True), nullable=True),
)
