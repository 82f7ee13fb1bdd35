"""The tables; `migrations/` brings a database to them."""

from sqlalchemy import Boolean, Column, DateTime, Index, MetaData, String, Table, Text

METADATA = MetaData()

PLANS = Table(
    "plans",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("robot", String(200), nullable=False),
    Column("request", Text, nullable=False),
    Column("answer", Text, nullable=False),
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
