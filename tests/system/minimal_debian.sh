#!/usr/bin/env bash
# Creates a minimal Debian 12 in a folder, with the packages of a fresh machine or a base image only.
# Uses the package mirrors of this machine (settings of apt and npm, added certificates).
# usage: minimal_debian.sh FOLDER        (as root; needs debootstrap)
set -euo pipefail

folder=${1:?usage: minimal_debian.sh FOLDER}
((EUID == 0)) || { echo "minimal_debian.sh: debootstrap needs root" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "minimal_debian.sh: apt-get install debootstrap" >&2; exit 1; }

mirror=$(apt-get indextargets --format '$(REPO_URI)' | grep --max-count=1 '/debian/\?$')
mkdir -p "$folder"
debootstrap --variant=minbase bookworm "$folder" "$mirror" >"$folder.log" 2>&1 || { tail "$folder.log" >&2; exit 1; }
chmod 755 "$folder" # mktemp makes folders that only root may enter; tests start PostgreSQL as another user

# carry SOURCE...: copies the existing ones to the same paths.
carry() {
    local path
    for path in "$@"; do
        [[ -e $path ]] || continue
        mkdir -p "$folder${path%/*}"
        cp --recursive --no-target-directory "$path" "$folder$path"
    done
}

[[ ! -e /etc/apt/sources.list.d/debian.sources ]] || rm -f "$folder/etc/apt/sources.list"
carry /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources /etc/apt/apt.conf.d \
    /usr/local/share/ca-certificates /etc/resolv.conf
npm_settings=$(npm config get globalconfig 2>/dev/null || true)
[[ ! -f $npm_settings ]] || cp "$npm_settings" "$folder/etc/npmrc" # where Debian's npm looks
