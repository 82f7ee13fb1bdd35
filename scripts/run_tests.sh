#!/bin/sh
# Tests: run_tests.sh FOLDER_OF_PYTEST [PLACE]...; without a place all of them. A place is a file or
# folder of tests, or one of the sources, whose tests lie in the same place under tests/.
#
# Two cores and three lanes. Tests that keep time with clocks run one by one, before all others.
# Services and commands, which wait now and then, run three at a time behind them, at a low priority
# that leaves their jobs, whose processes are nicer still, a share. What only computes fills the rest.
set -u
pytest=$1/pytest
shift

tests_of() {
    case $1 in
        tests | tests/*) echo "$1" ;;
        *.py) echo "tests/$(dirname "$1")/test_$(basename "$1")" ;;
        *) echo "tests/$1" ;;
    esac
}

if [ $# -gt 0 ]; then
    for place; do
        set -- "$@" "$(tests_of "${place%/}")"
        shift
    done
    exec "$pytest" "$@"
fi

waiting=$(mktemp)
computing=$(mktemp)
trap 'rm -f "$waiting" "$computing"' EXIT
failed=0

nice -n 14 "$pytest" -n 3 --dist loadfile --no-loadscope-reorder -m "not alone" \
    tests/app tests/deploy tests/docs >"$waiting" 2>&1 &
services=$!
nice -n 19 "$pytest" tests/bench tests/contracts tests/solver >"$computing" 2>&1 &
solver=$!
# Named, as collecting all to leave most out takes ten seconds.
# shellcheck disable=SC2046
"$pytest" -m alone $(grep -rlw --include="*.py" "mark.alone" tests) || failed=1
"$pytest" tests/hardware || failed=1
wait $services || failed=1
wait $solver || failed=1
cat "$waiting" "$computing"
exit $failed
