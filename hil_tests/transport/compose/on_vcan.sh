#!/bin/sh
# docker-compose.yml on a kernel with CAN, beside an engine that has the image: on_vcan.sh FOLDER PYTHON CASE...
#
#   vcan        the short move on the vcan0 that the containers make
#   published   the published scenario there, 195 s
#   hardware    the short move on can0 of the host
#   foreign     the same, with a controller outside the containers, as a board would be
#
# The host's interfaces are there: can0, which is up, and can1, which is down. FOLDER/project is a copy of the project.
# FOLDER/CASE gets the output of `up`, its exit code, what the engine says of the containers, the limits of the plant's
# process and the run folder; the tests look at it where the processor is faster.
set -eu
started_s=$(date +%s)
folder=$1
python=$2
shift 2
cd "$folder/project"
# An emulated machine takes its time to load the interpreters.
export COMPOSE_PROJECT_NAME=railhil-vcan SEED=0 START_TIMEOUT=300
# Who owns ./runs; root stays the default user's.
owner=$(stat -c %u runs)
[ "$owner" = 0 ] || export RAILHIL_UID="$owner" RAILHIL_GID="$(stat -c %g runs)"
mine="--filter label=com.docker.compose.project=$COMPOSE_PROJECT_NAME"
hardware="-f docker-compose.yml -f docker-compose.hardware.yml"

say() { echo "on_vcan: $* after $(($(date +%s) - started_s)) s" >&2; }

# Whatever a container could leave behind; of processes the command lines, for the numbers differ each time.
traces() {
    ls /sys/class/net
    docker ps -aq
    docker volume ls -q
    docker network ls --format '{{.Name}}'
    grep "$COMPOSE_PROJECT_NAME" /proc/mounts | grep -v " $folder " || true
    for process in /proc/[0-9]*; do tr '\0' ' ' <"$process/cmdline" 2>/dev/null || true; echo; done |
        grep -E 'railhi[l]|bus[.]hub|containerd-shi[m]' | grep -v on_vcan | sort || true
}

# Resource limits of the plant's process, into a file, soon after it has started.
limits_of_plant() {
    until container=$(docker ps -q $mine --filter label=com.docker.compose.service=plant) && [ -n "$container" ]; do
        sleep 5
    done
    cat "/proc/$(docker inspect -f '{{.State.Pid}}' "$container")/limits" >"$1"
}

# bench CASE SCENARIO [compose's file options] -- [options of up]
bench() {
    case=$folder/$1
    export SCENARIO="$2"
    shift 2
    mkdir "$case"
    files=
    while [ "$1" != -- ]; do files="$files $1"; shift; done
    shift
    limits_of_plant "$case/limits" &
    limits=$!
    code=0
    # shellcheck disable=SC2086  # words
    $RAILHIL_COMPOSE $files up --no-build --no-color --exit-code-from supervisor "$@" >"$case/out" 2>&1 || code=$?
    kill $limits 2>/dev/null || true
    echo $code >"$case/exit_code"
    # shellcheck disable=SC2086  # words
    [ -n "$(docker ps -aq $mine)" ] || { cat "$case/out" >&2; exit 1; }
    # shellcheck disable=SC2046,SC2086  # words
    docker inspect $(docker ps -aq $mine) >"$case/containers.json"
    mv runs/* "$case" 2>/dev/null || true
    # shellcheck disable=SC2086  # words
    $RAILHIL_COMPOSE $files down --volumes >>"$case/out" 2>&1
    say "$(basename "$case"): exit code $code"
}

foreign() {
    # After the plant, whose containers may take long to come up in a busy machine; it waits as long as they do.
    (
        until grep -qs 'plant.*socketcan:can0' "$folder/foreign/out" || [ -e "$folder/foreign/exit_code" ]; do sleep 1; done
        exec "$python" -m railhil.controller_node scenarios/short_move.toml -i socketcan -c can0 2>"$folder/controller.txt"
    ) &
    controller=$!
    # Limits do not change the bytes: they ride along.
    export RTPRIO=45 MEMLOCK=-1
    bench foreign "$1" $hardware -- --scale controller=0
    unset RTPRIO MEMLOCK
    code=0
    wait $controller || code=$?
    echo $code >"$folder/controller_exit_code"
}

traces >"$folder/before"
short=/scenarios/short_move.toml
for name in "$@"; do
    case $name in
    vcan) bench vcan $short -- ;;
    published) bench published lvshun_tieshan -- ;;
    hardware) bench hardware $short $hardware -- ;;
    foreign) foreign $short ;;
    esac
done
traces >"$folder/after"

# An interface that is down. The adapter alone has the say, so it is asked alone.
words="--rm --read-only --network host --cap-drop ALL --security-opt no-new-privileges --tmpfs /bus:mode=1777"
# shellcheck disable=SC2086,SC2016  # words; the shell in the container
docker run $words --env CAN_CHANNEL=can1 --entrypoint sh railhil-bench \
    -c 'bench adapter & until [ -e /bus/problem ]; do sleep 0.1; done; cat /bus/problem; kill $!' >"$folder/down"
say "all"
