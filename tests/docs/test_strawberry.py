"""docs/strawberry.md against the code: every number in its tables, and those in its words."""

import math
from dataclasses import replace

import pytest
from scipy.optimize import brentq

from solver.comparison.strawberry.analytic import solve_as
from solver.comparison.strawberry.as_printed import (
    solve_as_printed,
    solve_as_printed_18,
    solve_ssas_printed,
    solve_ssas_printed_without_30,
)
from solver.comparison.strawberry.mechanism import Mechanism, Point
from solver.comparison.strawberry.programme import solve_ncos
from solver.comparison.strawberry.semi_analytic import solve_ssas
from solver.comparison.strawberry.table_3 import MACHINE, PLANT_CENTRE_M, PLANT_RADIUS_M, table_3
from solver.comparison.strawberry.verification import verify_answer
from solver.problem.solution import Reason
from tests.docs.test_documents import ROOT, rows
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered

DOCUMENT = "docs/strawberry.md"
TEXT = " ".join((ROOT / DOCUMENT).read_text(encoding="utf-8").split())


def index_n_mm(method, target: Point, mechanism: Mechanism = MECHANISM) -> float:  # type: ignore[no-untyped-def]
    answer = answered(method(mechanism, target))
    found = verify_answer(mechanism, target, answer)
    assert found.verification.accepted
    return found.index_j * 1000


def table_beside_ours() -> list[list[str]]:
    expected = []
    for row in table_3():
        best, middle, worst = (
            index_n_mm(solve, row.target) for solve in (solve_ncos, solve_ssas, solve_as)
        )
        printed = row.index_n_mm["ncos"]
        expected.append(
            [
                row.label,
                f"{printed:.1f}",
                f"{best:.1f}",
                f"{100 * (best / printed - 1):+.3f}",
                f"{row.increase_pct['ssas']:.2f}",
                f"{100 * (middle / best - 1):.2f}",
                f"{row.increase_pct['as']:.2f}",
                f"{100 * (worst / best - 1):.2f}",
            ]
        )
    return expected


def cut_off_rows() -> list[list[str]]:
    expected = []
    for row in table_3():
        ours = index_n_mm(solve_as, row.target) - index_n_mm(solve_ncos, row.target)
        printed = row.index_n_mm["as"] - row.index_n_mm["ncos"]
        if printed < 426.7:
            expected.append([row.label, f"{printed:.1f}", f"{ours:.1f}"])
    return expected


def effect_of_m3() -> list[list[str]]:
    expected = []
    for weight_n in (0.0, MECHANISM.tip_weight_n, MECHANISM.lifted_n):
        changed = replace(MECHANISM, tip_weight_n=weight_n)
        best, middle, worst = (
            index_n_mm(solve, TARGETS[0], changed) for solve in (solve_ncos, solve_ssas, solve_as)
        )
        expected.append([f"{weight_n:g}", f"{middle - best:.1f}", f"{worst - best:.1f}"])
    return expected


def as_printed_rows() -> list[list[str]]:
    """What the first target's printed rows come to, and how many targets are solved."""
    expected = []
    for name, solve in (
        ("as_printed", solve_as_printed),
        ("as_printed_18", solve_as_printed_18),
        ("ssas_printed", solve_ssas_printed),
        ("ssas_printed_without_30", solve_ssas_printed_without_30),
    ):
        solved, dearer = 0, []
        for target in TARGETS:
            answer = solve(MECHANISM, target)
            if isinstance(answer, Reason):
                continue
            found = verify_answer(MECHANISM, target, answer)
            if found.verification.accepted:
                solved += 1
                dearer.append(found.index_j * 1000 - index_n_mm(solve_ssas, target))
        spread = f"{min(dearer):.1f} to {max(dearer):.1f}" if dearer else "-"
        expected.append([name, str(solved), spread])
    return expected


@pytest.mark.parametrize(
    ("section", "computed"),
    [
        ("Table 3 beside ours", table_beside_ours),
        ("Why AS's column cannot be reproduced", cut_off_rows),
        ("What the unknowns do", effect_of_m3),
        ("As printed", as_printed_rows),
    ],
)
def test_tables_are_what_the_code_computes(section: str, computed) -> None:  # type: ignore[no-untyped-def]
    written = [row[: len(computed()[0])] for row in rows(DOCUMENT, section)[2:]]
    assert written == computed()


def test_unknowns_are_those_of_the_mechanism() -> None:
    written = rows(DOCUMENT, "What is unknown")[2:]
    assert written == [
        [unknown.name, f"{unknown.value:g} {unknown.unit}", unknown.known]
        for unknown in MECHANISM.unknowns
    ]


def test_numbers_in_words_are_computed() -> None:
    """Each sentence is built from the numbers it tells."""
    worst = max(abs(float(row[3])) for row in table_beside_ours())
    assert f"within {worst:.3f} % in every row" in TEXT
    x, y, z = (f"{value * 1000:g}" for value in PLANT_CENTRE_M)
    assert f"{PLANT_RADIUS_M * 1000:g} mm about ({x}, {y}, {z}) mm" in TEXT
    assert f"{2000 * abs(MECHANISM.d_z_m):.1f} mm off" in TEXT
    assert MACHINE.split(",")[0] in TEXT
    mean_ms = {
        name: sum(row.time_s[name] for row in table_3()) / 20 * 1000
        for name in ("as", "ssas", "ncos")
    }
    means = "{as:.0f} ms, {ssas:.0f} ms and {ncos:.0f} ms".format(**mean_ms)
    assert means in TEXT
    assert f"{fitted_constant():.2f} N mm" in TEXT


def fitted_constant() -> float:
    """The middle of the range of what is left of the NCOS column [N mm]."""
    left = [
        row.index_n_mm["ncos"]
        - (9.81 * row.target[0] + 9.81 * row.target[1] - 24.525 * row.target[2]) * 1000
        for row in table_3()
    ]
    return (max(left) + min(left)) / 2


def test_misprinted_26_moves_the_root_of_30() -> None:
    """With theta = 0 and l2 for l1: u = sqrt(l3^2 - (u + l1 - l2)^2) with u = l3 sin(beta)."""
    m = MECHANISM

    def residual(beta: float) -> float:
        across = m.l3_m * math.sin(beta)
        return across - math.sqrt(m.l3_m**2 - (across + m.l1_m - m.l2_m) ** 2)

    assert f"{math.degrees(brentq(residual, 0.0, 1.2)):.2f}°" in TEXT


WEIGHTS_N = [MECHANISM.lifted_n * share / 20 for share in range(21)]


def with_theta_zero(mechanism: Mechanism, beta: float) -> float:
    """What of J depends on beta where theta is 0 [N mm]."""
    m = mechanism
    downwards = m.friction_n + m.lifted_n - m.tip_weight_n / 2
    return -1000 * m.l3_m * (m.friction_n * math.sin(beta) + downwards * math.cos(beta))


def test_no_choice_of_m3_meets_both_differences() -> None:
    """Both rise with it, and are met at values far apart."""
    pairs = []
    for weight_n in WEIGHTS_N:
        changed = replace(MECHANISM, tip_weight_n=weight_n)
        pairs.append(
            [
                index_n_mm(solve, TARGETS[0], changed) - index_n_mm(solve_ncos, TARGETS[0], changed)
                for solve in (solve_ssas, solve_as)
            ]
        )
    assert pairs == sorted(pairs)
    assert max(middle for middle, worst in pairs if worst <= 426.8) > 376.4 + 20
    assert min(max(abs(a - 376.4), abs(b - 426.8)) for a, b in pairs) > 15


def test_as_cannot_fall_as_printed_where_s10_cuts_it_off() -> None:
    """At y = 270 mm, over all that is open for d_y and m3 g: by 12 N mm at most, printed 41.4."""
    m = MECHANISM
    whole = math.asin(math.sin(m.beta.upper) / 2)
    falls = []
    for weight_n in WEIGHTS_N:
        changed = replace(m, tip_weight_n=weight_n)
        for d_y_mm in range(-87, -62):
            sine = (0.270 - m.l1_m + d_y_mm * 1e-3 - m.s10.lower) / (2 * m.l3_m)
            cut = with_theta_zero(changed, math.asin(sine))
            falls.append(with_theta_zero(changed, whole) - cut)
    assert 0 < max(falls) < 12 < 41.4


def test_bounds_of_d_y_are_those_that_table_3_gives() -> None:
    """AS's set is cut off at y = 285 mm and not at 310; NCOS's s10 is inside at y = 270."""
    m = MECHANISM
    half = m.l3_m * math.sin(m.beta.upper)
    lower, upper = ((m.s10.lower - y + half + m.l1_m) * 1000 for y in (0.310, 0.285))
    (known,) = [unknown.known for unknown in m.unknowns if unknown.name == "d_y"]
    assert f"between {lower:.1f} and {upper:.1f}" in known
    assert pytest.approx((lower + upper) / 2, abs=0.05) == m.d_y_m * 1000
    free = answered(solve_ncos(replace(m, tip_weight_n=0.0), TARGETS[0])).posture.beta_rad
    least = (m.s10.lower - 0.270 + m.l1_m + m.l3_m * math.sin(free)) * 1000
    assert f"above {least:.1f}" in known


def test_every_quadrants_ssas_difference_is_told() -> None:
    quadrants: dict[tuple[bool, bool], list[float]] = {}
    for row in table_3():
        place = (row.target[0] > PLANT_CENTRE_M[0], row.target[1] > PLANT_CENTRE_M[1])
        apart = row.index_n_mm["ssas"] - row.index_n_mm["ncos"]
        quadrants.setdefault(place, []).append(apart)
    means = [f"{sum(values) / len(values):.1f}" for values in quadrants.values()]
    assert ", ".join(means) in TEXT
