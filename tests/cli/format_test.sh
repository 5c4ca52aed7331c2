#!/usr/bin/env bash
# The sources are laid out as clang-format does it. Its releases differ, so only that of Debian 12 decides; exit code
# 77 says that it is not here.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
if [[ $(clang-format --version 2>/dev/null) != *'version 14.'* ]]; then
    echo 'skipped: clang-format 14 is not installed'
    exit 77
fi
find common chapters tests tools shaders/interface.h -name '*.cpp' -o -name '*.h' | sort | xargs clang-format --dry-run -Werror
