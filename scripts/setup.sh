#!/bin/sh
# Builds a virtual environment from a hashed lock file: setup.sh VENV LOCK
# Needs Python 3.11, 3.12 or 3.13; PYTHON may name the interpreter. Debian packages that are missing
# are installed with APT=1 only.
set -eu
venv=$1
lock=$2

fits() { "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; }

find_python() {
    for candidate in ${PYTHON:-python3 python3.13 python3.12 python3.11}; do
        if fits "$candidate"; then
            echo "$candidate"
            return
        fi
    done
    echo "prunus needs Python 3.11, 3.12 or 3.13; none of '${PYTHON:-python3 python3.13 python3.12 python3.11}' is one." >&2
    echo "On Debian: apt-get install python3 python3-venv" >&2
    exit 1
}

# Debian's python3 comes without ensurepip; the package python3-venv brings it.
ensure_venv_module() {
    "$python" -c 'import ensurepip, venv' 2>/dev/null && return
    package="python$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')-venv"
    if [ "${APT:-}" = 1 ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        echo "== installing $package (Python's venv module is missing)"
        apt-get update -q && apt-get install -y -q --no-install-recommends "$package"
    else
        echo "Python's venv module is missing. On Debian, as root: apt-get install $package" >&2
        echo "Or let it be installed, as root: make APT=1 ..." >&2
        exit 1
    fi
}

python=$(find_python)
ensure_venv_module
if ! fits "$venv/bin/python"; then
    echo "== creating $venv with $("$python" --version)"
    rm -rf "$venv"
    "$python" -m venv "$venv"
fi
echo "== installing $(grep -c '==' "$lock") locked packages from $lock"
"$venv/bin/python" -m pip install --disable-pip-version-check --require-hashes -r "$lock"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
echo "== compiling the kernels: some minutes, once for each version and processor"
"$venv/bin/python" -m solver.warm_up
