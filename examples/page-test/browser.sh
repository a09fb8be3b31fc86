# Sourced by the scripts beside it: gets Playwright for the system's Chromium, and gives `in_browser SCRIPT ARGUMENT...`.
# Without Chromium or npm there is nothing to run scripts with, which is said and is no failure.
pages=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
chromium=$(command -v chromium || command -v chromium-browser || true)
if [ -z "$chromium" ] || ! command -v npm >/dev/null; then
    echo 'the page is not checked: it takes the Debian packages chromium and npm'
    exit 0
fi
modules=$(mktemp -d)
trap 'rm -rf "$modules"' EXIT
cp "$pages"/*.mjs "$pages/package.json" "$modules"
npm install --prefix "$modules" --silent --no-audit --no-fund --no-package-lock

in_browser() {
    CHROMIUM="$chromium" node "$modules/$1" "${@:2}"
}
