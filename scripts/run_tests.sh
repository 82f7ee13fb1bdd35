#!/bin/sh
# Tests: run_tests.sh FOLDER_OF_PYTEST [PLACE]...; without a place all of them. A place is a file or
# folder of tests, or one of the sources, whose tests lie in the same place under tests/; for a source
# without a test of its own, those of the folder that it lies in.
#
# Two cores and three lanes. Tests that keep time with clocks run one by one, before all others.
# Services and commands, which wait now and then, run three at a time behind them, at a low priority
# that leaves their jobs, whose processes are nicer still, a share. What only computes fills the rest.
set -u
# A run starts some two hundred processes: without bytecode each compiles 300 files of ours anew.
unset PYTHONDONTWRITEBYTECODE
pytest=$1/pytest
shift

tests_of() {
    place=${1#"$PWD"/}
    place=${place#./}
    place=${place%/}
    case $place in
        tests | tests/*) echo "$place" && return ;;
        */__init__.py) place=${place%/*} ;;
        *.py)
            own=tests/${place%/*}/test_${place##*/}
            [ -f "$own" ] && echo "$own" && return
            place=${place%/*}
            ;;
    esac
    while [ ! -e "tests/$place" ]; do
        case $place in
            */*) place=${place%/*} ;;
            *) echo "there are no tests for $1" >&2 && return 2 ;;
        esac
    done
    echo "tests/$place"
}

if [ $# -gt 0 ]; then
    for place; do
        found=$(tests_of "$place") || exit 2
        [ "$found" = "${place%/}" ] || echo "== $place: $found"
        set -- "$@" "$found"
        shift
    done
    exec "$pytest" "$@"
fi

# With the priority $1 beside what is more urgent. Where Linux shares processors between sessions, a
# priority counts within one alone: a session of its own, which as a whole yields as $2 says.
yielding() {
    priority=$1 whole=$2
    shift 2
    [ -w /proc/self/autogroup ] || exec nice -n "$priority" "$@"
    exec setsid sh -c 'echo "$1" >/proc/self/autogroup; priority=$0; shift; exec nice -n "$priority" "$@"' \
        "$priority" "$whole" "$@"
}

waiting=$(mktemp)
computing=$(mktemp)
trap 'rm -f "$waiting" "$computing"' EXIT
failed=0

yielding 17 14 "$pytest" -n 3 --dist loadfile --no-loadscope-reorder -m "not alone" \
    tests/app tests/deploy tests/docs >"$waiting" 2>&1 &
services=$!
yielding 19 19 "$pytest" -n 2 --dist loadfile -m "not alone" tests --ignore tests/app --ignore tests/deploy \
    --ignore tests/docs --ignore tests/hardware --ignore tests/contracts/test_bus.py \
    >"$computing" 2>&1 &
solver=$!
# A shell without a terminal keeps an interrupt from what it has in the background.
trap 'kill $services $solver 2>/dev/null; exit 130' INT TERM
# Named, as collecting all to leave most out takes ten seconds.
# shellcheck disable=SC2046
"$pytest" -m alone $(grep -rlw --include="*.py" "mark.alone" tests) || failed=1
"$pytest" tests/hardware tests/contracts/test_bus.py || failed=1
wait $services || failed=1
wait $solver || failed=1
cat "$waiting" "$computing"
exit $failed
