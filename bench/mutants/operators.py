"""What is changed in a mutant: operators of Cosmic Ray, and statements that are left out."""

import itertools
from collections.abc import Iterator
from typing import Any, Final

from cosmic_ray.operators.operator import Example, Operator
from cosmic_ray.plugins import get_operator
from parso.python.tree import Keyword

_ARITHMETIC: Final = ("Add", "Sub", "Mul", "Div")
_ORDER: Final = ("Lt", "LtE", "Gt", "GtE", "Eq", "NotEq")

_CORE: Final = (
    *(f"ReplaceBinaryOperator_{a}_{b}" for a, b in itertools.permutations(_ARITHMETIC, 2)),
    *(f"ReplaceComparisonOperator_{a}_{b}" for a, b in itertools.permutations(_ORDER, 2)),
    "ReplaceComparisonOperator_Is_IsNot",
    "ReplaceComparisonOperator_IsNot_Is",
    "ReplaceUnaryOperator_Delete_Not",
    "ReplaceUnaryOperator_Delete_USub",
    "AddNot",
    "ReplaceTrueWithFalse",
    "ReplaceFalseWithTrue",
    "ReplaceAndWithOr",
    "ReplaceOrWithAnd",
    "ReplaceBreakWithContinue",
    "ReplaceContinueWithBreak",
    "NumberReplacer",
    "ZeroIterationForLoop",
)
"""Of Cosmic Ray's: a number divided with remainder or shifted by a float only fails, and a kernel
without its decorator is the same where it is interpreted."""


class LeaveOutStatement(Operator):  # type: ignore[misc]
    """Leaves out what no later line needs in order to run: calls, yields, changes in place."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
        """The statement, if it is one of these."""
        if node.type == "simple_stmt" and self._may_go(node.children[0]):
            yield node.start_pos, node.children[0].end_pos

    def mutate(self, node: Any, index: int) -> Any:
        """The statement as `pass`, on a line of its own as it was."""
        assert index == 0
        first = node.get_first_leaf()
        node.children[0] = Keyword("pass", first.start_pos, prefix=first.prefix)
        return node

    @staticmethod
    def _may_go(statement: Any) -> bool:
        if statement.type in ("yield_expr", "atom_expr"):
            return True
        if statement.type != "expr_stmt":
            return False
        target, operator = statement.children[:2]
        if operator.type != "operator":
            return False  # an annotation
        in_place: bool = operator.value != "=" or target.type == "atom_expr"
        return in_place

    @classmethod
    def examples(cls) -> tuple[Example, ...]:
        """One."""
        return (Example("f(x)\n", "pass\n"),)


def operators() -> dict[str, Operator]:
    """The operators by their names."""
    core = {name: get_operator(f"core/{name}")() for name in _CORE}
    return {**core, "LeaveOutStatement": LeaveOutStatement()}
