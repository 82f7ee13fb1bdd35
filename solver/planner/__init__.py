"""A problem solved: one target, many at once, a batch in parts, each answer built and verified."""
