"""Executions."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table of executions."""
    op.create_table(
        "executions",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("plan_id", sa.String(32), nullable=False),
        sa.Column("robot", sa.String(200), nullable=False),
        sa.Column("status", sa.String(32), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("updated_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("active_robot", sa.String(200), nullable=True, unique=True),
        sa.Column("document", sa.Text, nullable=False),
    )
    op.create_index("executions_by_age", "executions", ["created_at", "id"])


def downgrade() -> None:
    """Drop it."""
    op.drop_table("executions")
