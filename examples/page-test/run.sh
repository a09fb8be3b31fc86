#!/usr/bin/env bash
# Checks the page of a run in headless Chromium: run.sh PAGE OUTPUT, what the program printed with --json.
set -euo pipefail
exec "$(dirname "$0")/browser.sh" check.mjs "$@"
