#!/usr/bin/env bash
# Copies the documents of the package, and the files that their links name, to a folder, with the paths that they have in the
# source tree.
set -euo pipefail
unset CDPATH
(($# == 1)) || { echo "usage: documents.sh OUTPUT_DIRECTORY" >&2; exit 2; }
output=$(realpath "$1")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
for file in README.md ARCHITECTURE.md CHANGELOG.md CONTRIBUTING.md GLOSSARY.md SECURITY.md LICENSE packages.txt docs/*.md docs/internals/*.md docs/decisions/*.md docs/cluster/* docs/foxglove/* docs/observability/* docs/performance/* docs/pictures/*.png \
    docs/landmarks/*.md docs/landmarks/pictures/*.png docs/localization/*.md docs/localization/pictures/*.png \
    docker/Dockerfile docker/*.md docker/*.yaml docker/cluster/* proto/scanloom/v1/*.proto robot_client/examples/send_scan/send_scan.cpp robot_client/python/scanloom_client.py \
    robot_client/ros_bridge/README.md; do
    install -D --mode 644 "$file" "$output/$file"
done
