#!/usr/bin/env bash
# Formats all C++ sources by .clang-format.
# Usage: scripts/format.sh [--check]      --check: changes nothing, fails when a file is not formatted
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

command -v clang-format >/dev/null || { echo "format: clang-format is missing: apt-get install clang-format" >&2; exit 1; }
options=(-i)
[ "${1:-}" != --check ] || options=(--dry-run --Werror)
git ls-files -z '*.cpp' '*.hpp' | xargs -0 clang-format "${options[@]}"
