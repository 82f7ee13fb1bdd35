"""Robot models: a TOML file a robot, what reads and writes them, rigid motions."""
