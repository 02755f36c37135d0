#!/bin/sh
# docker-compose.yml on a kernel with CAN, beside an engine that has the image: on_vcan.sh FOLDER PYTHON
#
# The interfaces are there: can0, which is up, and can1, which is down.
# FOLDER/project is a copy of the project. For each case FOLDER/CASE is left, with the output of `up`, its exit code, what
# the engine says of the containers, limits of the plant's process, and the run folder; the tests look at it where the
# processor is faster.
set -eu
folder=$1
python=$2
cd "$folder/project"
export COMPOSE_PROJECT_NAME=railhil-vcan
# Who owns ./runs; root stays the default user's.
owner=$(stat -c %u runs)
[ "$owner" = 0 ] || export RAILHIL_UID="$owner" RAILHIL_GID="$(stat -c %g runs)"
mine="--filter label=com.docker.compose.project=$COMPOSE_PROJECT_NAME"
# An emulated machine takes its time to load five interpreters.
export START_TIMEOUT=300
hardware="-f docker-compose.yml -f docker-compose.hardware.yml"

# Whatever a container could leave behind.
traces() {
    ls /sys/class/net
    docker ps -aq
    docker volume ls -q
    docker network ls --format '{{.Name}}'
    grep -c railhil-vcan /proc/mounts || true
    # Of another process identifier each time: the names alone.
    for process in /proc/[0-9]*; do tr '\0' ' ' <"$process/cmdline" 2>/dev/null || true; echo; done |
        grep -E 'railhil|bus\.hub|containerd-shim' | grep -v on_vcan || true
}

# Resource limits of the plant's process, into a file, as soon as it runs.
limits_of_plant() {
    until container=$(docker ps -q $mine --filter label=com.docker.compose.service=plant) && [ -n "$container" ]; do
        sleep 1
    done
    cat "/proc/$(docker inspect -f '{{.State.Pid}}' "$container")/limits" >"$1"
}

# up CASE [compose's file options] -- [options of up]
up() {
    case=$folder/$1
    mkdir "$case"
    shift
    files=
    while [ "$1" != -- ]; do files="$files $1"; shift; done
    shift
    limits_of_plant "$case/limits" &
    limits=$!
    code=0
    started_s=$(date +%s)
    # shellcheck disable=SC2086  # words
    $RAILHIL_COMPOSE $files up --no-build --no-color --exit-code-from supervisor "$@" >"$case/out" 2>&1 || code=$?
    echo "on_vcan: $(basename "$case"): exit code $code after $(($(date +%s) - started_s)) s" >&2
    kill $limits 2>/dev/null || true
    echo $code >"$case/exit_code"
    # shellcheck disable=SC2046  # words
    docker inspect $(docker ps -aq $mine) >"$case/containers.json"
    mv runs/* "$case" 2>/dev/null || true
}

traces >"$folder/before"

up vcan --
$RAILHIL_COMPOSE down --volumes

export SCENARIO=/scenarios/short_move.toml
# Limits do not change the bytes: they ride along.
up hardware $hardware -f docker-compose.realtime.yml --

# Outside the containers, as a board would be: started first, it is slow to load.
"$python" -m controller_node scenarios/short_move.toml -i socketcan -c can0 2>"$folder/foreign.txt" &
foreign=$!
up foreign $hardware -- --scale controller=0
code=0
wait $foreign || code=$?
echo $code >"$folder/foreign_exit_code"
$RAILHIL_COMPOSE $hardware down --volumes
traces >"$folder/after"

# An interface that is down. The adapter alone has the say, so it is asked alone.
words="--rm --read-only --network host --cap-drop ALL --security-opt no-new-privileges --tmpfs /bus:mode=1777"
docker run $words --env CAN_CHANNEL=can1 --entrypoint sh railhil-bench \
    -c 'bench adapter & until [ -e /bus/problem ]; do sleep 0.1; done; cat /bus/problem; kill $!' >"$folder/down"
