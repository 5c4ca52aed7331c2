#!/usr/bin/env bash
# Gradescope runs this once, as root and with a network: installs what the lab needs and builds the chapter.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
chapter=$(sed -n 's/^chapter=\([0-9]*\).*/\1/p' run_autograder)
lab/lab install
# Builds the program. What it says of the unfinished shader does not matter here; 2 means that nothing could be graded.
lab/lab check "$chapter" --runs 2 || [[ $? == 1 ]]
