#!/usr/bin/env bash
# Checks that a fresh Debian 12 needs only a checkout: creates a minimal one in a temporary folder, clones this commit
# into it, and runs the two commands of the README there, as root in a chroot.
# usage: bare_system.sh        (as root; needs debootstrap, git, and the network for packages)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Mounts are in a namespace of this script, and therefore end with it.
if [[ ${1:-} != --in-own-namespace ]]; then
    ((EUID == 0)) || { echo "bare_system.sh: a chroot needs root" >&2; exit 1; }
    exec unshare --mount --pid --fork --kill-child "$0" --in-own-namespace
fi

system=$(mktemp --directory --tmpdir scanloom-bare.XXXXXX)
remove() {
    umount --recursive --lazy "$system/proc" "$system/dev" 2>/dev/null || true
    # Does not remove other file systems: /dev is the machine's own.
    rm --recursive --force --one-file-system "$system" "$system.log"
}
trap remove EXIT

# inside COMMAND...: runs in the bare system, in the clone, with the environment of a first login.
inside() {
    chroot "$system" env --ignore-environment HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
        /bin/bash -c 'cd /root/scanloom && exec "$@"' bash "$@"
}

# timed COMMAND...: prints how long it took, with processor time.
timed() {
    local TIMEFORMAT="== $*: %0R s, %0U + %0S s of processor time"
    echo "== $*"
    time inside "$@"
}

echo "== a minimal Debian 12 in $system"
tests/system/minimal_debian.sh "$system"
mount -t proc proc "$system/proc"
mount --rbind /dev "$system/dev"
git clone --quiet --no-local . "$system/root/scanloom"

timed ./scanloom demo --for 20 | tee "$system.log"
grep --quiet ' [1-9][0-9]* scans were stored' "$system.log" || { echo "the demo mapped nothing" >&2; exit 1; }
timed ./scanloom test
timed ./scanloom test # again: nothing is installed or built
echo "== the bare system runs both commands"
