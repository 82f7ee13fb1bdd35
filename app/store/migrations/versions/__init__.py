"""A file a version of the schema, applied in order; none is changed afterwards."""
