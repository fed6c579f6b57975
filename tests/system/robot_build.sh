#!/usr/bin/env bash
# Checks the robots' sections of packages.txt: in a minimal Debian 12 with the packages of [build-robot], this commit's
# robot program and client library are built; in another one, the program runs with those of [run-robot], and the
# example is built on the installed library with those of [library].
# usage: robot_build.sh        (as root; needs debootstrap, git, and the network for packages)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Mounts are in a namespace of this script, and therefore end with it.
if [[ ${1:-} != --in-own-namespace ]]; then
    ((EUID == 0)) || { echo "robot_build.sh: a chroot needs root" >&2; exit 1; }
    exec unshare --mount --pid --fork --kill-child "$0" --in-own-namespace
fi

work=$(mktemp --directory --tmpdir scanloom-robot.XXXXXX)
remove() {
    umount --recursive --lazy "$work"/*/proc "$work"/*/dev 2>/dev/null || true
    # Does not remove other file systems: /dev is the machine's own.
    rm --recursive --force --one-file-system "$work"
}
trap remove EXIT

# inside SYSTEM COMMAND...: runs in one of the systems, in the clone, with the environment of a first login.
inside() {
    chroot "$work/$1" env --ignore-environment HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb CCACHE_DISABLE=1 \
        /bin/bash -c 'cd /root/scanloom && exec "$@"' bash "${@:2}"
}

# timed SYSTEM COMMAND...: prints how long it took.
timed() {
    local since=$SECONDS
    echo "== $1: ${*:2}"
    inside "$@"
    echo "== $1: ${*:2}: $((SECONDS - since)) s"
}

echo "== two minimal Debian 12 in $work"
tests/system/minimal_debian.sh "$work/builder"
git clone --quiet --no-local . "$work/builder/root/scanloom"
cp --archive "$work/builder" "$work/robot"
for system in builder robot; do
    mount -t proc proc "$work/$system/proc"
    mount --rbind /dev "$work/$system/dev"
done

timed builder ./scanloom install build-robot
timed builder ./scanloom build --robot
inside builder cmake --install build/robot --prefix /opt/scanloom
cp --archive "$work/builder/opt/scanloom" "$work/robot/opt/"

timed robot ./scanloom install run-robot
inside robot /opt/scanloom/bin/scanloom-robot --help >"$work/help"
grep --quiet -- --session "$work/help" || { echo "scanloom-robot does not start" >&2; exit 1; }

timed robot ./scanloom install library
inside robot cmake -S robot_client/examples/send_scan -B /tmp/send_scan -DCMAKE_PREFIX_PATH=/opt/scanloom
timed robot cmake --build /tmp/send_scan
# No server listens on port 1: it starts, waits for the given time, and reports the failure.
! inside robot /tmp/send_scan/send_scan 127.0.0.1:1 2>"$work/news" || { echo "send_scan succeeded without a server" >&2; exit 1; }
grep --quiet 'send_scan: 1 scan was not stored within 10 s' "$work/news" || { cat "$work/news" >&2; exit 1; }

echo "== the packages suffice"
