#!/usr/bin/env bash
# Runs a script of this folder with Playwright and the system's Chromium: browser.sh SCRIPT ARGUMENT...
# Without Chromium or npm there is nothing to run it with, which is said and is no failure.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
chromium=$(command -v chromium || command -v chromium-browser || true)
if [ -z "$chromium" ] || ! command -v npm >/dev/null; then
    echo 'the page is not checked: it takes the Debian packages chromium and npm'
    exit 0
fi
modules=$(mktemp -d)
trap 'rm -rf "$modules"' EXIT
cp "$here/package.json" "$here/$1" "$modules"
npm install --prefix "$modules" --silent --no-audit --no-fund --no-package-lock
CHROMIUM="$chromium" node "$modules/$1" "${@:2}"
