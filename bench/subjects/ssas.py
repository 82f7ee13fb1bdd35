"""`ssas` with its cut-ins in a batch, against the peers' sweeps of the thinning posture alone."""

import numpy as np

from bench.measure import Row, alternating, failed, ratios, row, scaled
from bench.peers import installed_peers, least_efforts
from bench.targets import random_set
from solver import solve
from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH

WANTED_US = 60.0
WANTED_RATIO = 20.0
SWEEPS = (50, 360)


def measure(quick: bool) -> list[Row]:
    """Microseconds a target on one core, batch of 1,000 seeded targets."""
    targets, runs = random_set(3, 50 if quick else 1000), 3 if quick else 9
    problem = targets.problem(method="ssas", order="independent", include=("path",))
    start = np.asarray(problem.start)

    def optima() -> object:
        return closed_form_optima(problem, targets.positions, targets.directions, start)

    actions = {"ssas": optima, "plan": lambda: solve(problem)}
    for peer in installed_peers():
        for angles in SWEEPS:
            actions[f"{peer.name}, {angles} angles"] = lambda peer=peer, angles=angles: (
                least_efforts(  # type: ignore[misc]
                    peer, problem, targets, angles
                )
            )
    times = alternating(actions, runs)
    each = {name: scaled(values, 1e6 / len(targets)) for name, values in times.items()}
    found = closed_form_optima(problem, targets.positions, targets.directions, start)
    share = np.count_nonzero(found.branches != NO_BRANCH) / len(targets)
    rows = [
        row(
            "ssas, target with its 20 cut-in postures",
            each.pop("ssas"),
            "µs a target",
            at_most=WANTED_US,
            note=f"batch of {len(targets)}, {100 * share:.0f} % of which have an approach",
        ),
        row(
            "verified plan by ssas, with refused targets explained",
            each.pop("plan"),
            "µs a target",
            note="`solve`, order independent, path included",
        ),
    ]
    rows += [
        row(name, values, "µs a target", note="thinning posture only, no cut-in")
        for name, values in each.items()
    ]
    return [*rows, _ratio(times)]


def _ratio(times: dict[str, list[float]]) -> Row:
    name = "times faster than the fastest peer's 360-angle sweep"
    peers = [key for key in times if key.endswith("360 angles")]
    if not peers:
        return failed(name, "", "no peer is installed", f">= {WANTED_RATIO:g}")
    fastest = min(peers, key=lambda key: float(np.median(times[key])))
    return row(
        name,
        ratios(times[fastest], times["ssas"]),
        "",
        at_least=WANTED_RATIO,
        note=f"{fastest}; run by run",
    )
