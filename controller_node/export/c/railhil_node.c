/* The exported law as a stand-alone controller, on the bus or at the end of two streams. For the host (Linux).
 *
 *   @PROGRAM@ [-w S] [-p S] can INTERFACE   raw CAN socket, e.g. vcan0, can0
 *   @PROGRAM@ [-w S] [-p S] hub PATH        Unix socket of the hub (railhil bus hub -c PATH)
 *   @PROGRAM@ [-w S] [-p S] slcan DEVICE    serial line of an adapter, e.g. /dev/ttyACM0
 *   @PROGRAM@ pipe                          records of railhil_pipe.h on standard input and output
 *
 *   -w S   seconds to wait for the first frame of the bench (default 300)
 *   -p S   patience in lockstep: the program ends when the bench has been silent for S seconds (default 62: the plant
 *          may wait 60 s for another node). In real time it ends after 3 s of silence.
 *
 * Exit code 0: the run has ended; 2: bad command line, a bus that cannot be opened, or nodes that do not agree on what
 * to run; 3: the bus is gone or silent. On a board, the board's main loop replaces this file.
 */
#define _POSIX_C_SOURCE 200809L

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "railhil_pipe.h"
#include "railhil_socket.h"

enum { EXIT_ENDED = 0, EXIT_USAGE = 2, EXIT_LOST = 3 };
/* Silence that ends the program. The first limit is long: the other nodes may be started by hand, on a busy machine. */
enum { FIRST_FRAME_S = 300, PATIENCE_S = 62, SILENCE_S = 3, WAIT_MAX_S = 3600 };

static void say_how_it_went(const railhil_bus_t *bus, const railhil_control_t *control)
{
    unsigned i;
    const unsigned long steps = control->law.steps;
    fprintf(stderr, "@PROGRAM@: %s: %lu control periods, run event %d", bus->channel, steps, control->ended);
    for (i = RAILHIL_WRONG_LENGTH; i < RAILHIL_COUNTS; i++) {
        if (control->counts[i] != 0) {
            fprintf(stderr, ", %lu %s", (unsigned long)control->counts[i], railhil_count_name(i));
        }
    }
    if (bus->dropped != 0) {
        fprintf(stderr, ", %lu answers dropped", bus->dropped);
    }
    fprintf(stderr, "\n");
}

static int serve(railhil_bus_t *bus, railhil_control_t *control, long first_frame_s, long patience_s)
{
    struct can_frame frames[RAILHIL_PACKET_FRAMES];
    railhil_frame_t answer[RAILHIL_FRAMES_MAX];
    int64_t heard_ms = railhil_now_ms();
    long limit_s = first_frame_s;
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
            limit_s = control->rate_10th == 0 ? patience_s : SILENCE_S;
        } else if (railhil_now_ms() - heard_ms > limit_s * (int64_t)1000) {
            fprintf(stderr, "@PROGRAM@: %s: waits for the bus administrator (plant): ", bus->channel);
            fprintf(stderr, "no frame of the bench for %ld s\n", limit_s);
            return EXIT_LOST;
        }
    }
    return control->ended == RAILHIL_REFUSED ? EXIT_USAGE : EXIT_ENDED;
}

/* Kind of bus of a word of the command line, -1: none. */
static int kind_of(const char *word)
{
    return strcmp(word, "can") == 0     ? RAILHIL_BUS_CAN
           : strcmp(word, "hub") == 0   ? RAILHIL_BUS_HUB
           : strcmp(word, "slcan") == 0 ? RAILHIL_BUS_SLCAN
                                        : -1;
}

/* Seconds of an option; 0 if the text is not an integer from 1 to WAIT_MAX_S. */
static long seconds(const char *text)
{
    char *end;
    const long found = strtol(text, &end, 10);
    return end == text || *end != '\0' || found < 1 || found > WAIT_MAX_S ? 0 : found;
}

/* Where the answers of the pipe go; -1: there is none. */
static int answers = -1;

/* What the code of a user prints must not stand among the answers. */
static void open_pipe(void)
{
    answers = dup(STDOUT_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
}

void railhil_fail(const char *line)
{
    if (answers >= 0) {
        railhil_pipe_failure(line);
    } else {
        fprintf(stderr, "@PROGRAM@: %s\n", line);
    }
    exit(EXIT_USAGE);
}

size_t board_read(unsigned char *octets, size_t most)
{
    const ssize_t size = read(STDIN_FILENO, octets, most);
    return size < 0 ? 0 : (size_t)size;
}

void board_write(const unsigned char *octets, size_t count)
{
    while (count != 0) {
        const ssize_t size = write(answers, octets, count);
        if (size < 0) {
            exit(EXIT_LOST);
        }
        octets += size;
        count -= (size_t)size;
    }
}

uint32_t board_free_stack(void)
{
    return 0;
}

int main(int argc, char **argv)
{
    static railhil_control_t control;
    railhil_bus_t bus;
    long first_frame_s = FIRST_FRAME_S;
    long patience_s = PATIENCE_S;
    int option;
    int kind;
    int exit_code;
    opterr = 0;
    while ((option = getopt(argc, argv, "w:p:")) != -1) {
        const long found = option == '?' ? 0 : seconds(optarg);
        if (found == 0) {
            fprintf(stderr, "@PROGRAM@: found %s, allowed -w S, -p S with 1 to %d s\n",
                    option == '?' ? argv[optind - 1] : optarg, WAIT_MAX_S);
            return EXIT_USAGE;
        }
        *(option == 'w' ? &first_frame_s : &patience_s) = found;
    }
    argv += optind;
    argc -= optind;
    railhil_init(&control);
    if (argc == 1 && strcmp(argv[0], "pipe") == 0) {
        open_pipe();
        return railhil_pipe_serve(&control) == 0 ? EXIT_ENDED : EXIT_USAGE;
    }
    kind = argc == 2 ? kind_of(argv[0]) : -1;
    if (kind < 0) {
        fprintf(stderr, "@PROGRAM@: found %d arguments, ", argc);
        fprintf(stderr, "allowed can INTERFACE, hub PATH, slcan DEVICE, or pipe\n");
        return EXIT_USAGE;
    }
    if (railhil_bus_open(&bus, (railhil_bus_kind_t)kind, argv[1]) != 0) {
        return EXIT_USAGE;
    }
    exit_code = serve(&bus, &control, first_frame_s, patience_s);
    if (exit_code == EXIT_USAGE) {
        fprintf(stderr, "@PROGRAM@: %s: the nodes do not agree on what to run; railhil run says in what\n",
                bus.channel);
    }
    say_how_it_went(&bus, &control);
    close(bus.socket);
    return exit_code;
}
