#!/usr/bin/env bash
# The entry point of the image `database`: PostgreSQL that confirms a commit when a standby has it too.
set -euo pipefail

usage='usage: database.sh primary [HOST] [OPTION...]      a new database, or a standby of HOST if a database runs there
       database.sh standby HOST [OPTION...]        a standby of the database that runs at HOST, once it does
The mode and HOST matter only while the volume is empty; later, the volume is that of a primary or of a standby.
Each OPTION is one of postgres, such as -c shared_buffers=1GB.'

fail() {
    echo "database.sh: $1" >&2
    exit "${2:-1}"
}

# Waits for a program so that a signal ends both.
run() {
    "$@" &
    wait $!
}
trap 'kill $(jobs -p) 2>/dev/null || true; wait; fail "ended by a signal before PostgreSQL was started"' INT TERM

# create_primary FOLDER: the superuser is postgres, for connections within the container only.
create_primary() {
    run initdb --pgdata "$1" --username postgres --encoding UTF8 --locale C --auth trust --no-instructions
    # Without passwords: only containers of a private network can connect.
    printf '%s\n' 'local all all trust' 'host scanloom scanloom samenet trust' 'host replication standby samenet trust' \
        >"$1/pg_hba.conf"
    # Here no server runs, and no standby is named yet: with one, each of these statements would wait for it.
    printf '%s\n' 'CREATE ROLE scanloom LOGIN' 'CREATE ROLE standby LOGIN REPLICATION' 'CREATE DATABASE scanloom OWNER scanloom' |
        postgres --single -D "$1" -c exit_on_error=on postgres >/dev/null
    echo "synchronous_standby_names = 'standby'" >>"$1/postgresql.conf"
}

# state_of HOST: 0 if its database accepts connections, 1 if it starts, 2 if it does not answer.
state_of() {
    local state=0
    pg_isready --quiet --host "$1" --username scanloom --dbname scanloom || state=$?
    echo "$state"
}

# create_standby FOLDER HOST
create_standby() {
    until [[ $(state_of "$2") == 0 ]]; do
        echo "database.sh: waiting for the database at '$2'"
        run sleep 1
    done
    run pg_basebackup --pgdata "$1" --host "$2" --username standby --write-recovery-conf --checkpoint fast
}

mode=${1:-}
[[ $mode == primary || $mode == standby ]] || fail "the mode is '$mode', but must be primary or standby; $usage" 2
shift
host=
[[ $# == 0 || $1 == -* ]] || { host=$1 && shift; }
[[ $mode == primary || -n $host ]] || fail "the mode standby needs the host of the primary; $usage" 2
((EUID != 0)) || fail "PostgreSQL does not run as root; start this as the user postgres"
: "${PGDATA:?is not set; it must be a folder in the volume, which need not exist}"
[[ -w ${PGDATA%/*} ]] || fail "${PGDATA%/*} is not writable for $(id --user --name); mount a volume there that belongs to this user"

if [[ ! -e $PGDATA ]]; then
    rm --recursive --force "$PGDATA.new" # of a start that was interrupted
    if [[ $mode == primary && (-z $host || $(state_of "$host") == 2) ]]; then
        create_primary "$PGDATA.new"
    else
        create_standby "$PGDATA.new" "$host"
    fi
    mv "$PGDATA.new" "$PGDATA"
    sync "${PGDATA%/*}"
fi

trap - INT TERM
# As a standby it calls itself by its cluster_name. After a failover it asks again for the log each second.
exec postgres -c listen_addresses='*' -c unix_socket_directories="${PGDATA%/*}" -c cluster_name=standby \
    -c wal_retrieve_retry_interval=1s "$@"
