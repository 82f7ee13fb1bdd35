"""What import-linter cannot see of the floors."""

from grimp import build_graph


def test_no_room_of_the_solver_imports_its_face() -> None:
    """The face names the files behind it in strings, so an import of it could hide a circle."""
    graph = build_graph("solver", cache_dir=None)
    assert graph.find_modules_that_directly_import("solver") == set()
