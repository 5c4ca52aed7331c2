#!/usr/bin/env bash
# Runs a command on a virtual display of its own: tests/support/with_display.sh COMMAND...
# xvfb-run does the same, but sometimes fails when several run at a time. Without Xvfb the display is the one there is, if any.
set -euo pipefail
command -v Xvfb >/dev/null || exec "$@"
exec 3< <(exec Xvfb -displayfd 1 -screen 0 1280x1024x24 -nolisten tcp -noreset 2>/dev/null)
server=$!
trap 'kill "$server" 2>/dev/null || true' EXIT
read -r number <&3
unset WAYLAND_DISPLAY  # the user's desktop would come first
DISPLAY=:$number "$@"
