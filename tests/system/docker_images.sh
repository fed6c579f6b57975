#!/usr/bin/env bash
# Builds the images of docker/Dockerfile without a Docker engine, on a base image made here, then starts the server's
# image, checks its health check, and streams a map to it from the robot's image.
# usage: docker_images.sh        (as root; needs buildah, debootstrap, iproute2, procps, and the network for packages)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

((EUID == 0)) || { echo "docker_images.sh: debootstrap and chroot need root" >&2; exit 1; }
export BUILDAH_ISOLATION=chroot

storage() { echo --storage-driver vfs --root "$work/storage" --runroot "$work/run"; }

# shellcheck disable=SC2046 # no spaces in them
buildah() { command buildah $(storage) "$@"; }

# setting IMAGE NAME: a setting of the image; the items of a list one a line.
setting() {
    buildah inspect --type image --format "{{range .Docker.Config.$2}}{{println .}}{{end}}" "localhost/scanloom-$1" |
        sed '/^$/d'
}

build_base() {
    local container
    tests/system/minimal_debian.sh "$work/debian"
    container=$(buildah from scratch)
    buildah copy --quiet "$container" "$work/debian" / >/dev/null
    buildah config --env PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$container"
    buildah commit --quiet --rm "$container" localhost/scanloom-base >/dev/null
    rm --recursive --force --one-file-system "$work/debian"
}

# build_image TARGET
build_image() {
    local user
    buildah bud --format docker --layers --build-arg BASE=localhost/scanloom-base --file docker/Dockerfile \
        --target "$1" --tag "localhost/scanloom-$1" . >"$work/$1.log" 2>&1 || { tail --lines 60 "$work/$1.log"; exit 1; }
    user=$(buildah inspect --type image --format '{{.Docker.Config.User}}' "localhost/scanloom-$1")
    [[ $user == scanloom ]] || { echo "the $1's image runs as '$user', not as scanloom" >&2; exit 1; }
}

# Retries COMMAND... for half a minute until it succeeds.
eventually() {
    local attempt
    for attempt in {1..60}; do
        "$@" && return
        sleep 0.5
    done
    echo "after $attempt attempts still failing: $*" >&2
    exit 1
}

# Starts the server's image by its entry point, runs its health check, and maps a room with the robot's image.
run_images() {
    local server_container robot_container entrypoint health server session
    ip link set lo up
    server_container=$(buildah from localhost/scanloom-server)
    robot_container=$(buildah from localhost/scanloom-robot)
    mapfile -t entrypoint < <(setting server Entrypoint)
    mapfile -t health < <(setting server Healthcheck.Test)

    # shellcheck disable=SC2046
    (exec buildah $(storage) run "$server_container" -- "${entrypoint[@]}") & # exec: $! is the process to stop
    server=$!
    eventually buildah run "$server_container" -- "${health[@]:1}"
    echo "== the server is healthy"
    buildah run "$robot_container" -- scanloom-robot --server 127.0.0.1:7447 --session office --robot r1 \
        simulate --world office --drive wall_follower --seed 1 --scans 300 --speed 0
    exec 3<>/dev/tcp/127.0.0.1/8080
    printf 'GET /api/v1/sessions/office HTTP/1.0\r\nHost: localhost\r\n\r\n' >&3
    session=$(cat <&3)
    [[ $session == *'"scans":300'* ]] || { echo "the server's session does not have the robot's 300 scans: $session" >&2; exit 1; }
    exec 3<>/dev/tcp/127.0.0.1/8080
    printf 'GET / HTTP/1.0\r\nHost: localhost\r\n\r\n' >&3
    [[ $(cat <&3) == *'<html'* ]] || { echo "the server's image has no viewer" >&2; exit 1; }
    # Signals the server itself: buildah would end the container on a signal.
    kill "$(pgrep --ns $$ --nslist net --exact scanloom-server)"
    wait "$server" || { echo "the server's container failed when it was stopped" >&2; exit 1; }
}

if [[ ${1:-} == --run ]]; then
    work=$2
    run_images
    exit
fi

work=$(mktemp --directory --tmpdir scanloom-docker.XXXXXX)
remove() {
    buildah rm --all >/dev/null || true
    buildah rmi --all --force >/dev/null || true
    rm --recursive --force --one-file-system "$work"
}
trap remove EXIT

echo "== a minimal Debian 12 as the base image"
build_base
for target in server robot load; do
    echo "== the image of the $target"
    build_image "$target"
done
echo "== the server and a robot, from their images, in a network of their own"
unshare --net "$0" --run "$work"
echo "== the images work"
