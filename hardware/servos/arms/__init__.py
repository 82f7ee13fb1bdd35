"""Which servos drive which joint: a TOML file a robot."""
