"""The store's schema, version by version, and what applies it."""
