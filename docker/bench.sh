#!/bin/sh
# Role of one container of the bench: bench bus | plant | controller | supervisor | results
#
# The containers share the network namespace of `bus` and the volume /bus, where they leave for each other
#   can       python-can's interface and channel, one per line: written by `bus`, waited for by the others
#   results   written by `results` when ./runs can be written to
#   verdict   exit code of the supervisor; every role ends when it appears
# The names in capitals come from docker-compose.yml.
set -eu
role=${1:?role: bus, plant, controller, supervisor or results}
start_s=60

say() { echo "$role: $*" >&2; }

# Wait until a file of the volume is there, at most start_s seconds.
await() {
    tries=$((start_s * 10))
    until [ -e "/bus/$1" ]; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || { say "/bus/$1 did not appear within $start_s s"; exit 3; }
        sleep 0.1
    done
}

# A file appears in the volume whole or not at all.
leave() { cat >"/bus/$1.part" && mv "/bus/$1.part" "/bus/$1"; }

# Run a command so that a stop of the container reaches it (the shell is process 1 and must pass it on).
run() {
    "$@" &
    child=$!
    trap 'kill -TERM $child 2>/dev/null; wait $child || true; exit 143' TERM INT
    code=0
    wait $child || code=$?
    trap 'exit 143' TERM INT
}

# Containers end after the supervisor, so that `--abort-on-container-exit` never cuts it short.
end_with_verdict() {
    trap 'exit 143' TERM INT
    until [ -e /bus/verdict ]; do
        if [ -n "${hub:-}" ] && ! kill -0 "$hub" 2>/dev/null; then say "the hub has ended"; exit 3; fi
        sleep 0.5
    done
    sleep 1
    exit "${1:-0}"
}

read_bus() {
    await can
    { read -r interface && read -r channel; } </bus/can
}

case $role in
bus)
    if reason=$(ip link add dev vcan0 type vcan 2>&1 && ip link set dev vcan0 up 2>&1); then
        say "socketcan:vcan0 (the kernel has vcan; the interface lives in this container's namespace)"
        printf 'socketcan\nvcan0\n' | leave can
    else
        python3 -m bus.hub -c /bus/hub.sock &
        hub=$!
        trap 'kill -TERM $hub 2>/dev/null; exit 143' TERM INT
        await hub.sock
        say "railhil:/bus/hub.sock, the user-space hub (no vcan0: ${reason:-ip failed})"
        printf 'railhil\n/bus/hub.sock\n' | leave can
    fi
    end_with_verdict
    ;;
plant)
    read_bus
    run railhil node plant "$SCENARIO" --pace "$PACE" --seed "$SEED" -i "$interface" -c "$channel"
    [ $code -eq 0 ] || say "ended with $code"
    end_with_verdict $code
    ;;
controller)
    read_bus
    run railhil node controller "$SCENARIO" --controller "$CONTROLLER" --arithmetic "$ARITHMETIC" \
        -i "$interface" -c "$channel"
    [ $code -eq 0 ] || say "ended with $code"
    end_with_verdict $code
    ;;
supervisor)
    read_bus
    await results
    read -r problem </bus/results || problem=
    code=2
    if [ -n "$problem" ]; then
        say "$problem"
    else
        # The run folder's default name is below ./runs, which is /runs from here.
        cd /
        run railhil run "$SCENARIO" --attach --controller "$CONTROLLER" --arithmetic "$ARITHMETIC" \
            --seed "$SEED" --pace "$PACE" --quiet -i "$interface" -c "$channel"
    fi
    echo $code | leave verdict
    exit $code
    ;;
results)
    # Runs as root without any capability: as the owner of a folder that root (or the engine) made, it may open it to
    # the group of the bench. A folder of somebody else is left alone.
    owner=$(stat -c %u /runs)
    if [ "$owner" = 0 ] && [ "$BENCH_UID" != 0 ]; then
        chgrp "$BENCH_GID" /runs && chmod g+rwx /runs
    elif [ "$owner" != "$BENCH_UID" ]; then
        echo "./runs belongs to user $owner, the bench runs as $BENCH_UID: start with RAILHIL_UID=$owner" \
            "RAILHIL_GID=$(stat -c %g /runs)" | leave results
        end_with_verdict
    fi
    : | leave results
    end_with_verdict
    ;;
*)
    say "unknown role, allowed: bus, plant, controller, supervisor, results"
    exit 2
    ;;
esac
