"""The subjects: a file and a row of `bench.registry` each, `measure(quick) -> list[Row]`."""
