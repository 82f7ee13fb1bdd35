"""A problem solved as a whole: one target, many at once, a batch in parts; all verified."""
