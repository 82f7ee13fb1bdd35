"""`python -m bench.mutants`: makes mutants of rooms, and tells which of them no test notices."""

import argparse
import sys
from typing import Final

from bench.mutants.outcomes import ENDLESS, UNTESTED, Outcome, explained, keep, read
from bench.mutants.rooms import REPOSITORY, ROOMS, digest_of, sources_of
from bench.mutants.running import run
from bench.mutants.sample import Mutant, sampled

FOLDER: Final = REPOSITORY / "build" / "mutants"
COUNT: Final = 150
MOST_LIVING: Final = 0.15
"""Share of a room's mutants that may live."""


def main() -> int:
    """Prints what became of them and keeps it; 1 where too many live."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rooms", nargs="*", default=ROOMS, help="by default all that decide")
    parser.add_argument("--count", type=int, default=COUNT, help="mutants of each room")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="try once more those that lived")
    given = parser.parse_args()
    if empty := [room for room in given.rooms if not sources_of(room)]:
        parser.error(f"no sources in {', '.join(empty)}")
    results = [_room(room, given.count, given.seed, again=given.again) for room in given.rooms]
    return 0 if all(results) else 1


def _room(room: str, count: int, seed: int, *, again: bool) -> bool:
    """Whether few enough live."""
    sources = sources_of(room)
    file = FOLDER / f"{room.replace('/', '-')}-{digest_of(sources)}-{seed}.jsonl"
    mutants = sampled(sources, count, seed)
    known = {_key(one): one for one in read(file) if not (again and one.lives)}
    wanted = set(map(_key_of, mutants))
    known = {key: one for key, one in known.items() if key in wanted}
    left = [mutant for mutant in mutants if _key_of(mutant) not in known]
    print(f"{room}: {len(mutants)} mutants, {len(left)} to be run", flush=True)
    for outcome in run(left, FOLDER / "durations"):
        keep(file, outcome)
        known[_key(outcome)] = outcome
        if outcome.lives:
            print(_shown(outcome), flush=True)
    return _told(room, list(known.values()))


def _told(room: str, outcomes: list[Outcome]) -> bool:
    living = [one for one in outcomes if one.lives]
    reasons = explained(living)
    counts = {what: sum(one.verdict == what for one in outcomes) for what in (ENDLESS, UNTESTED)}
    share = len(living) / max(1, len(outcomes))
    print(
        f"{room}: of {len(outcomes)} live {len(living)} ({share:.0%}), {len(reasons)} of them "
        f"explained; {counts[UNTESTED]} had no test that is quick enough, {counts[ENDLESS]} "
        "never ended",
        flush=True,
    )
    return share <= MOST_LIVING


def _shown(outcome: Outcome) -> str:
    place = f"{outcome.source}:{outcome.line}, {outcome.operator}, {outcome.tests} tests"
    return f"   {outcome.verdict} {place}\n      - {outcome.before}\n      + {outcome.after}"


def _key_of(mutant: Mutant) -> tuple[str, str, int]:
    return str(mutant.source.relative_to(REPOSITORY)), mutant.operator, mutant.occurrence


def _key(outcome: Outcome) -> tuple[str, str, int]:
    return outcome.source, outcome.operator, outcome.occurrence


if __name__ == "__main__":
    sys.exit(main())
