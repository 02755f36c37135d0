#!/bin/sh
# Role of one container of the bench: bench bus | adapter | plant | controller | supervisor | results | panel | door
#
# The containers share one network namespace (that of `bus`, or with `adapter` the host's) and the volume /bus, where
# they leave for each other
#   can       python-can's interface, its channel and the command that has started the containers, one per line: written
#             by `bus` or `adapter`, waited for by the nodes
#   results   written by `results` when ./runs can be written to
#   problem   in place of either: the line that says why not
#   verdict   exit code of the supervisor; every role ends when it appears
# The names in capitals come from docker-compose.yml and docker-compose.hardware.yml.
set -eu
role=${1:?role: bus, adapter, plant, controller, supervisor, results, panel or door}
# linux/if_arp.h and linux/if.h
arphrd_can=280
iff_up=1
up="up --exit-code-from supervisor"

say() { echo "$role: $*" >&2; }

# A wrong setting must not count as a missing one. The commands check all others.
only() { say "$1: found $2, allowed $3"; exit 2; }
case ${START_TIMEOUT:-60} in *[!0-9]*) only START_TIMEOUT "$START_TIMEOUT" "whole seconds" ;; esac
case ${WAIT:-1} in 1) ;; *) only WAIT "$WAIT" "1, or nothing" ;; esac
case ${CATALOGUE:-1} in 1) ;; *) only CATALOGUE "$CATALOGUE" "1, or nothing" ;; esac
# Whether the panel is one of the containers.
case ,${PROFILES:-}, in *,panel,*) paged=1 ;; *) paged= ;; esac
if [ -z "$paged" ]; then
    case $role in panel | door) only COMPOSE_PROFILES "${PROFILES:-nothing}" "panel, as a variable: all roles read it" ;; esac
    [ -z "${WAIT:-}${CATALOGUE:-}" ] || only "WAIT, CATALOGUE" "${WAIT:-}${CATALOGUE:-}" "nothing without COMPOSE_PROFILES=panel"
fi

# Wait until a file of the volume is there; not zero if the file of a problem is there instead.
await() {
    tries=$((START_TIMEOUT * 10))
    until [ -e "/bus/$1" ]; do
        [ ! -e /bus/problem ] || return 1
        tries=$((tries - 1))
        [ $tries -gt 0 ] || { say "/bus/$1 did not appear within $START_TIMEOUT s"; exit 3; }
        sleep 0.1
    done
}

# A file appears in the volume only when it is complete.
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

# A problem is told by the supervisor alone; the other nodes end with it.
read_bus() {
    await can || { [ "$role" = supervisor ] || end_with_verdict; refused; }
    { read -r interface && read -r channel && read -r started; } </bus/can
}

refused() {
    read -r problem </bus/problem
    say "$problem"
    echo 2 | leave verdict
    exit 2
}

# The command that repeats this run: it starts the containers, not only the supervisor.
again() {
    echo "SCENARIO='$SCENARIO' CONTROLLER=$CONTROLLER ARITHMETIC=$ARITHMETIC SEED=$SEED PACE=$PACE RATE=$RATE $started"
}

# The law that runs where none is chosen: the default of the scenario's system, whose notes the panel then names.
# Nothing for a scenario that cannot be loaded, which the panel itself reports.
usual_law() {
    python3 -c 'import sys
from railhil.scenarios.load import load_any
from railhil.scenarios.system import system_named
print(system_named(load_any(sys.argv[1]).system).law)' "$SCENARIO" 2>/dev/null || true
}

# Flags of the pace. The default rate belongs to no pace; another one is passed on, and refused in lockstep.
pacing() {
    echo --pace "$PACE"
    if [ "$PACE" = realtime ] || [ "$RATE" != 1 ]; then echo --rate "$RATE"; fi
}

# Time for which the plant waits for the supervisor, s: with WAIT a person presses Start first, and the controller waits
# 300 s for its first frame.
appear() {
    if [ -n "${WAIT:-}" ] && [ "$START_TIMEOUT" -lt 300 ]; then echo 300; else echo "$START_TIMEOUT"; fi
}

# SCHED_FIFO priority to ask for: none in lockstep, which has no deadlines.
priority() {
    if [ "$PACE" = realtime ]; then echo "$1"; else echo 0; fi
}

# The reason why an interface of this network namespace cannot be the bus; nothing when it can.
why_not() {
    device=/sys/class/net/$1
    bring_up="sudo ip link set $1 type can bitrate 500000 && sudo ip link set $1 txqueuelen 1000 up"
    if [ ! -e "$device" ]; then
        echo "$1: the host has no such interface (CAN_CHANNEL names it; bring it up with: $bring_up)"
    elif [ "$(cat "$device/type")" != $arphrd_can ]; then
        echo "$1: is no CAN interface (CAN_CHANNEL names one)"
    elif [ $(($(cat "$device/flags") & iff_up)) = 0 ]; then
        echo "$1: the interface is down (bring it up on the host with: $bring_up)"
    fi
}

# Faults that the page injects, one a line: the nodes run before the supervisor, and all three are given the same ones.
# Nothing without a panel, or in lockstep without WAIT, which is over before a button is pressed.
prepared() {
    if [ -z "$paged" ] || { [ "$PACE" != realtime ] && [ -z "${WAIT:-}" ]; }; then return; fi
    python3 -c 'import sys
from railhil.cli.panel import prepared_faults
print(*prepared_faults(sys.argv[1], bool(sys.argv[2])), sep="\n")' "$SCENARIO" "${CATALOGUE:-}" 2>/dev/null ||
        say "no faults are prepared for the page; why is said when the node starts"
}

# The words of the nodes' faults, whose logs the supervisor takes from the volume.
set --
case $role in plant | controller | supervisor)
    faults=$(prepared)
    if [ -n "$faults" ]; then
        mkdir -p /bus/faults
        while IFS= read -r fault; do set -- "$@" --fault "$fault"; done <<END
$faults
END
        case $role in
        plant) set -- "$@" --fault-logs /bus/faults ;;
        controller) set -- "$@" --fault-logs /bus/faults --seed "$SEED" ;;
        supervisor) set -- "$@" --fault-logs /bus/faults ;;
        esac
    fi
    ;;
esac

case $role in
bus)
    if reason=$(ip link add dev vcan0 type vcan 2>&1 && ip link set dev vcan0 up 2>&1); then
        say "socketcan:vcan0 (the kernel has vcan; the interface lives in this container's namespace)"
        printf 'socketcan\nvcan0\ndocker compose %s\n' "$up" | leave can
    else
        # A frame is carried before a node goes on.
        python3 -m railhil.bus.hub -c /bus/hub.sock --realtime-priority "$(priority 45)" &
        hub=$!
        trap 'kill -TERM $hub 2>/dev/null; exit 143' TERM INT
        await hub.sock
        say "railhil:/bus/hub.sock, the user-space hub (no vcan0: ${reason:-ip failed})"
        printf 'railhil\n/bus/hub.sock\ndocker compose %s\n' "$up" | leave can
    fi
    end_with_verdict
    ;;
adapter)
    problem=$(why_not "$CAN_CHANNEL")
    if [ -n "$problem" ]; then
        echo "$problem" | leave problem
    else
        say "socketcan:$CAN_CHANNEL (the host's interface; its bit rate is the host's)"
        printf 'socketcan\n%s\nCAN_CHANNEL=%s docker compose %s %s\n' "$CAN_CHANNEL" "$CAN_CHANNEL" \
            "-f docker-compose.yml -f docker-compose.hardware.yml" "$up" | leave can
    fi
    end_with_verdict
    ;;
plant)
    read_bus
    run railhil node plant "$SCENARIO" $(pacing) --seed "$SEED" \
        --appear-timeout "$(appear)" --patience "$PATIENCE" "$@" -i "$interface" -c "$channel"
    [ $code -eq 0 ] || say "ended with $code"
    end_with_verdict $code
    ;;
controller)
    read_bus
    run railhil node controller "$SCENARIO" ${CONTROLLER:+--controller "$CONTROLLER"} \
        ${ARITHMETIC:+--arithmetic "$ARITHMETIC"} --patience "$PATIENCE" --realtime-priority "$(priority 40)" "$@" \
        -i "$interface" -c "$channel"
    [ $code -eq 0 ] || say "ended with $code"
    end_with_verdict $code
    ;;
supervisor)
    read_bus
    await results || refused
    # The run folder's default name is below ./runs, which is /runs from here.
    cd /
    run railhil run "$SCENARIO" --attach ${CONTROLLER:+--controller "$CONTROLLER"} \
        ${ARITHMETIC:+--arithmetic "$ARITHMETIC"} --seed "$SEED" $(pacing) --appear-timeout "$START_TIMEOUT" \
        --patience "$PATIENCE" --rerun-command "$(again)" --quiet \
        ${paged:+--operator /bus/operator.sock} ${WAIT:+--wait} "$@" -i "$interface" -c "$channel"
    echo $code | leave verdict
    exit $code
    ;;
results)
    # Runs as root without any capability: as the owner of a folder that root (or the engine) made, it may open it to
    # the group of the bench. A folder of another user is left alone.
    owner=$(stat -c %u /runs)
    if [ "$owner" = 0 ] && [ "$BENCH_UID" != 0 ]; then
        chgrp "$BENCH_GID" /runs && chmod g+rwx /runs
    elif [ "$owner" != "$BENCH_UID" ]; then
        echo "./runs belongs to user $owner, the bench runs as $BENCH_UID: start with RAILHIL_UID=$owner" \
            "RAILHIL_GID=$(stat -c %g /runs)" | leave problem
        end_with_verdict
    fi
    : | leave results
    end_with_verdict
    ;;
panel)
    read_bus
    law=${CONTROLLER:-$(usual_law)}
    railhil panel "$SCENARIO" ${law:+--controller "$law"} --socket /bus/panel.sock \
        --public-port "$PANEL_PORT" --operator /bus/operator.sock -i "$interface" -c "$channel" &
    end_with_verdict
    ;;
door)
    python3 -m railhil.panel.tcp_to_unix /bus/panel.sock 8765 &
    end_with_verdict
    ;;
*)
    say "unknown role, allowed: bus, adapter, plant, controller, supervisor, results, panel, door"
    exit 2
    ;;
esac
