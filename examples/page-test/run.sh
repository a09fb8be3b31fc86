#!/usr/bin/env bash
# Checks the page of a run in headless Chromium: run.sh PAGE OUTPUT, what the program printed with --json.
set -euo pipefail
. "$(dirname "$0")/browser.sh"
in_browser check.mjs "$@"
