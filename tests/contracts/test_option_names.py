"""The names that options take are the rows of the registries, in their order."""

from solver.methods.nlp.backends import BACKENDS
from solver.methods.nlp.quadratic import QP_SOLVERS
from solver.methods.registry import METHODS
from solver.problem.options import BACKEND_NAMES, METHOD_NAMES, QP_SOLVER_NAMES


def test_every_name_has_a_row_and_every_row_a_name() -> None:
    assert tuple(METHODS) == METHOD_NAMES
    assert tuple(BACKENDS) == BACKEND_NAMES
    assert tuple(QP_SOLVERS) == QP_SOLVER_NAMES
