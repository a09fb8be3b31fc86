#!/usr/bin/env bash
# Starts the live page of the programs in a folder, and leads its person in headless Chromium:
# live.sh PROGRAMS OUTPUT [SECONDS of random dragging]. What was done is saved to the folder OUTPUT.
set -euo pipefail
. "$(dirname "$0")/browser.sh"
mkdir -p "$2"
log="$2/live.log"
started=$(date +%s%3N)
"$1/live" --quiet --json > "$log" &
live=$!
trap 'kill -INT "$live" 2> /dev/null || true; rm -rf "$modules"' EXIT
for _ in $(seq 600); do
    grep -q '^http' "$log" && break
    sleep 0.05
done
address=$(sed -n '1s/ .*//p' "$log")
in_browser live.mjs "$address" "$started" "$2" "${3:-0}" "$live"
kill -INT "$live"
# Ctrl-C ends it in order, the robot at rest.
wait "$live"
tail -n 1 "$log" | grep -q '"at_rest":true'
tail -n 1 "$log" | grep -q '"limit_violations":0,"separation_violations":0,'
