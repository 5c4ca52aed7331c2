#!/usr/bin/env bash
# The sources are laid out by tools, and no Python uses a name that it does not define. Releases of the tools differ, so only those
# of Debian 12 decide; exit code 77 says that they are not here. `tests/cli/format_test.sh --write` lays everything out.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
if [[ $(clang-format --version 2>/dev/null) != *'version 14.'* || $(black --version 2>/dev/null) != 'black, 23.'* ]]; then
    echo 'skipped: clang-format 14 or black 23 is not installed'
    exit 77
fi
[[ ${1-} == --write ]] && clang=(-i) black=(--quiet) || clang=(--dry-run -Werror) black=(--quiet --check --diff)
sources() { find chapters common notebook tests tools shaders/interface.h lab "$@" | sort; }
sources -name '*.cpp' -o -name '*.h' -o -name '*.js' | xargs clang-format "${clang[@]}"
sources -name '*.py' | xargs black "${black[@]}" --skip-magic-trailing-comma --line-length 130 --target-version py311
undefined=$(sources -name '*.py' | xargs pyflakes3 | grep 'undefined name' || true)
[[ -z $undefined ]] || { echo "$undefined" && exit 1; }
