/* The exported law as a controller of its own on the bus: Linux SocketCAN, or the bench's hub. For the host only.
 *
 *   @LAW@_node can INTERFACE   raw CAN socket, e.g. vcan0, can0
 *   @LAW@_node hub PATH        Unix socket of the hub (railhil bus hub -c PATH)
 *
 * Exit code 0: the run has ended; 2: bad command line, a bus that cannot be opened, or nodes that do not agree on what
 * to run; 3: the bus is gone or silent. On a board its main loop takes the place of this file.
 */
#include <stdio.h>
#include <unistd.h>

#include "railhil_control.h"
#include "railhil_socket.h"

enum { EXIT_ENDED = 0, EXIT_USAGE = 2, EXIT_LOST = 3 };
/* Silence that ends the program: at first the other nodes may be started by hand. */
enum { FIRST_FRAME_MS = 60000, SILENCE_MS = 3000 };

static void say_how_it_went(const railhil_bus_t *bus, const railhil_control_t *control)
{
    unsigned i;
    const unsigned long steps = control->steps;
    fprintf(stderr, "@LAW@_node: %s: %lu control periods, run event %d", bus->channel, steps, control->ended);
    for (i = RAILHIL_WRONG_LENGTH; i < RAILHIL_COUNTS; i++) {
        if (control->guard.counts[i] != 0) {
            fprintf(stderr, ", %lu %s", (unsigned long)control->guard.counts[i], railhil_count_name(i));
        }
    }
    if (bus->dropped != 0) {
        fprintf(stderr, ", %lu answers dropped", bus->dropped);
    }
    fprintf(stderr, "\n");
}

static int serve(railhil_bus_t *bus, railhil_control_t *control)
{
    struct can_frame frames[RAILHIL_PACKET_FRAMES];
    railhil_frame_t answer[RAILHIL_FRAMES_MAX];
    int64_t heard_ms = railhil_now_ms();
    int patience_ms = FIRST_FRAME_MS;
    while (control->ended == 0) {
        const int count = railhil_bus_receive(bus, frames);
        int heard = 0;
        int i;
        if (count < 0) {
            return EXIT_LOST;
        }
        for (i = 0; i < count; i++) {
            unsigned answers;
            if (!railhil_is_let_in(bus, &frames[i])) {
                continue;
            }
            heard = 1;
            answers = railhil_receive(control, frames[i].can_id, frames[i].can_dlc, frames[i].data, answer);
            if (answers != 0 && railhil_bus_send(bus, answer, answers, control->rate_10th == 0) != 0) {
                return EXIT_LOST;
            }
        }
        if (heard) {
            heard_ms = railhil_now_ms();
            patience_ms = SILENCE_MS;
        } else if (railhil_now_ms() - heard_ms > patience_ms) {
            fprintf(stderr, "@LAW@_node: %s: no frame of the bench for %d s\n", bus->channel,
                    patience_ms / 1000);
            return EXIT_LOST;
        }
    }
    return control->ended == RAILHIL_REFUSED ? EXIT_USAGE : EXIT_ENDED;
}

int main(int argc, char **argv)
{
    static railhil_control_t control;
    railhil_bus_t bus;
    int exit_code;
    if (argc != 3 || (strcmp(argv[1], "can") != 0 && strcmp(argv[1], "hub") != 0)) {
        fprintf(stderr, "@LAW@_node: found %d arguments, allowed can INTERFACE, or hub PATH\n", argc - 1);
        return EXIT_USAGE;
    }
    if (railhil_bus_open(&bus, strcmp(argv[1], "hub") == 0, argv[2]) != 0) {
        return EXIT_USAGE;
    }
    railhil_init(&control);
    exit_code = serve(&bus, &control);
    if (exit_code == EXIT_USAGE) {
        fprintf(stderr, "@LAW@_node: %s: the nodes do not agree on what to run; railhil run says in what\n",
                bus.channel);
    }
    say_how_it_went(&bus, &control);
    close(bus.socket);
    return exit_code;
}
