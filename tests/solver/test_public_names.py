import doctest

import solver


def test_documented_example_runs() -> None:
    result = doctest.testmod(solver)
    assert result.attempted >= 4
    assert result.failed == 0


def test_every_public_name_is_there_and_documented() -> None:
    for name in solver.__all__:
        assert getattr(solver, name).__doc__, name
    assert list(solver.__all__) == sorted(solver.__all__)
