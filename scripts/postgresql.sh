#!/bin/sh
# Makes sure, before the tests, of a PostgreSQL server's programs: postgresql.sh
# The tests run the store against a real server and start one of their own, so the Debian package
# must not make and start one too, which it does unless told not to. With APT=1 it is installed.
set -eu

ls /usr/lib/postgresql/*/bin/initdb >/dev/null 2>&1 && exit
command -v initdb >/dev/null && exit
if [ "${APT:-}" = 1 ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "== installing postgresql (the tests start a server of their own)"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -q
    apt-get install -y -q --no-install-recommends postgresql-common
    settings=/etc/postgresql-common/createcluster.conf
    sed -i '/^#*create_main_cluster/d' "$settings"
    echo "create_main_cluster = false" >>"$settings"
    apt-get install -y -q --no-install-recommends postgresql
    exit
fi
[ "${APT:-}" != 1 ] || echo "== APT=1 needs root and apt-get." >&2
echo "== PostgreSQL is not installed: tests of the store on it will be SKIPPED (CI=true: fail)." >&2
echo "   On Debian, as root: apt-get install postgresql; or let it be installed: make APT=1 ..." >&2
