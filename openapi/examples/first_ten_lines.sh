#!/bin/sh
# The same key for every try: the batch is planned once, however often the network drops.
set -eu
url=${PRUNUS_URL:-http://127.0.0.1:8000}
key=$(cat /proc/sys/kernel/random/uuid)
curl -sSf --retry 5 --retry-all-errors "$url/v1/plans" \
    -H 'Content-Type: application/json' -H "Idempotency-Key: $key" \
    -d @openapi/examples/data_set_3.json
