#!/bin/sh
# Tests: run_tests.sh FOLDER_OF_PYTEST [PLACE]...; without a place all of them. A place is a file or
# folder of tests, or one of the sources, whose tests lie in the same place under tests/.
#
# Two cores, so what mostly waits shares them with what computes: tests that keep time with clocks
# run one by one, and beside them all others, three at a time, as most wait now and then, and at a
# low priority. It is not the lowest, so that jobs, whose processes are nicer than their service, get
# their share among them.
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

shared=$(mktemp)
trap 'rm -f "$shared"' EXIT
failed=0

nice -n 14 "$pytest" -n 3 --dist loadfile --no-loadscope-reorder -m "not alone" \
    tests --ignore tests/hardware >"$shared" 2>&1 &
# Named, as collecting all to leave most out takes ten seconds.
# shellcheck disable=SC2046
"$pytest" -m alone $(grep -rlw --include="*.py" "mark.alone" tests) || failed=1
"$pytest" tests/hardware || failed=1
wait $! || failed=1
cat "$shared"
exit $failed
