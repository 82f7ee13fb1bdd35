#!/bin/sh
# Every test: run_tests.sh FOLDER, of pytest. Two cores, so what only waits shares them with what
# only computes: tests that keep time with clocks run one by one, and the solver's, which keep none,
# beside them at the lowest priority. A third of those that share leaves no core idle.
set -u
pytest=$1/pytest
computing=$(mktemp)
trap 'rm -f "$computing"' EXIT
failed=0

"$pytest" -n 3 --dist loadfile -m "not alone" tests/app tests/docs tests/contracts || failed=1
nice -n 19 "$pytest" -n 2 tests/solver tests/bench >"$computing" 2>&1 &
"$pytest" -m alone tests/app tests/docs || failed=1
"$pytest" tests/hardware || failed=1
wait $! || failed=1
cat "$computing"
exit $failed
