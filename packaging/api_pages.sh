#!/usr/bin/env bash
# Writes the pages of the C++ API (docs/api). Fails with doxygen's warnings if a header lacks a description.
set -euo pipefail
unset CDPATH
(($# == 2)) || { echo "usage: api_pages.sh VERSION OUTPUT_DIRECTORY" >&2; exit 2; }
cd "$(dirname "${BASH_SOURCE[0]}")/.."
version=$1
mkdir -p "$2"
output=$(realpath "$2")
check=$(mktemp --directory --tmpdir scanloom-api.XXXXXX)
trap 'rm -rf "$check"' EXIT

# pages OUTPUT_DIRECTORY [SETTING...]
pages() {
    { cat docs/api/Doxyfile && printf '%s\n' "PROJECT_NUMBER = $version" "OUTPUT_DIRECTORY = \"$1\"" "${@:2}"; } | doxygen -
}

# The headers of the client library: every parameter and every returned value.
pages "$check" 'INPUT = docs/api/pages.dox robot_client/client/client.hpp common/scan/poses.hpp common/scan/scan.hpp common/scan/sensor.hpp' \
    'WARN_NO_PARAMDOC = YES'
pages "$output"

# The pages need no scripts.
sed -i '/<script type="text\/javascript" src="[a-z]*\.js"><\/script>/d' "$output"/*.html
rm "$output"/*.js
