#!/usr/bin/env bash
# Builds the images of docker/Dockerfile without a Docker engine, on a base image made here, then starts the server's
# image, checks its health check, and streams a map to it from the robot's image. Then the same with three nodes, a database and its
# standby, while a node and the primary are killed.
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
    local user expected=scanloom
    [[ $1 != database ]] || expected=postgres
    buildah bud --format docker --layers --build-arg BASE=localhost/scanloom-base --file docker/Dockerfile \
        --target "$1" --tag "localhost/scanloom-$1" . >"$work/$1.log" 2>&1 || { tail --lines 60 "$work/$1.log"; exit 1; }
    user=$(buildah inspect --type image --format '{{.Docker.Config.User}}' "localhost/scanloom-$1")
    [[ $user == "$expected" ]] || { echo "the $1's image runs as '$user', not as $expected" >&2; exit 1; }
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

# start IMAGE COMMAND...: starts a command in a new container; sets `container`, and `process` to the process to wait for.
start() {
    container=$(buildah from "localhost/scanloom-$1")
    # shellcheck disable=SC2046
    (exec buildah $(storage) run "$container" -- "${@:2}") & # exec: $! is the process to wait for
    process=$!
}

# signal SIGNAL COMMAND: sends it to the program whose command line begins so; buildah itself would end the container on a signal.
signal() { kill "-$1" "$(pgrep --full "^([^ ]*/)?$2")"; }

# stop SIGNAL COMMAND PROCESS: and waits until the process has ended.
stop() {
    signal "$1" "$2"
    wait "$3" || { echo "the container of '$2' failed when it was stopped" >&2; exit 1; }
}

# get ADDRESS PATH: the answer of the server there.
get() {
    exec 3<>"/dev/tcp/$1/8080" && printf 'GET %s HTTP/1.0\r\nHost: localhost\r\n\r\n' "$2" >&3 && cat <&3
}

# answers ADDRESS PATH TEXT: the answer contains this text.
answers() { [[ $(get "$1" "$2" 2>/dev/null) == *"$3"* ]]; }

# has_scans ADDRESS MINIMUM: the session has at least these.
has_scans() { [[ $(get "$1" /api/v1/sessions/office 2>/dev/null) =~ '"scans":'([0-9]+) ]] && ((BASH_REMATCH[1] >= $2)); }

# start_robot SERVERS SCANS SPEED
start_robot() {
    start robot scanloom-robot --server "$1" --session office --robot r1 \
        simulate --world office --drive wall_follower --seed 1 --scans "$2" --speed "$3"
}

# Starts the server's image by its entry point, runs its health check, and maps a room with the robot's image.
run_server() {
    local entrypoint health server
    mapfile -t entrypoint < <(setting server Entrypoint)
    mapfile -t health < <(setting server Healthcheck.Test)
    start server "${entrypoint[@]}"
    server=$process
    eventually buildah run "$container" -- "${health[@]:1}"
    echo "== the server is healthy"
    start_robot 127.0.0.1:7447 300 0
    wait "$process"
    answers 127.0.0.1 /api/v1/sessions/office '"scans":300' || { echo "the server does not have the robot's 300 scans" >&2; exit 1; }
    answers 127.0.0.1 / '<html' || { echo "the server's image has no viewer" >&2; exit 1; }
    stop TERM 'scanloom-server ' "$server"
}

# start_database ADDRESS MODE HOST: starts the database's image, and waits until it is healthy.
start_database() {
    local entrypoint health
    mapfile -t entrypoint < <(setting database Entrypoint)
    mapfile -t health < <(setting database Healthcheck.Test)
    start database "${entrypoint[@]}" "$2" "$3" -c listen_addresses="$1"
    eventually buildah run "$container" -- "${health[@]:1}"
}

# Three nodes and two databases as in compose.cluster.yaml, each with an address of its own. While a robot streams, the node
# of its session is killed, and then the primary, in whose place the standby is promoted as docker/README.md describes.
run_cluster() {
    local primary=127.0.0.1 standby=127.0.0.2 databases=() nodes=(127.0.0.11 127.0.0.12 127.0.0.13) node owner robot
    local -A processes
    start_database $primary primary $standby
    start_database $standby standby $primary
    databases=("$container" "$process")
    for node in "${nodes[@]}"; do
        start server scanloom-server "--node=$node" "--listen=$node:7447" "--http=$node:8080" \
            "--store=postgresql://scanloom@$primary,$standby/scanloom"
        processes[$node]=$process
        eventually answers "$node" /readyz ' 200 '
    done
    start_robot "${nodes[0]}:7447,${nodes[1]}:7447,${nodes[2]}:7447" 600 2
    robot=$process
    eventually has_scans "${nodes[0]}" 50

    owner=$(get "${nodes[0]}" /api/v1/nodes | grep --only-matching '"name":"[^"]*"[^}]*"sessions":1' | cut --delimiter '"' --fields 4)
    echo "== the node $owner, which has the session, is killed"
    signal KILL "scanloom-server --node=$owner "
    unset "processes[$owner]"
    nodes=("${!processes[@]}")
    eventually has_scans "${nodes[0]}" 150
    kill -0 "$robot" # it still streams

    echo "== the primary is killed, and the standby promoted"
    signal KILL "postgres .*listen_addresses=$primary"
    buildah run "${databases[0]}" -- pg_ctl promote
    start_database $primary primary $standby # with an empty volume: now a standby
    wait "$robot" || { echo "the robot could not store all scans" >&2; exit 1; }
    for node in "${nodes[@]}"; do
        answers "$node" /api/v1/sessions/office '"scans":600' || { echo "the node $node does not have the robot's 600 scans" >&2; exit 1; }
        stop TERM "scanloom-server --node=$node " "${processes[$node]}"
    done
    stop INT "postgres .*listen_addresses=$primary" "$process"
    stop INT "postgres .*listen_addresses=$standby" "${databases[1]}"
}

if [[ ${1:-} == --run ]]; then
    work=$2
    ip link set lo up
    run_server
    run_cluster
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
for target in database server robot load; do
    echo "== the image of the $target"
    build_image "$target"
done
echo "== servers, databases and robots from their images, in a network of their own"
unshare --net --pid --fork --kill-child --mount-proc "$0" --run "$work" # all processes end with it
echo "== the images work"
