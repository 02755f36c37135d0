/* The exported law as a controller of its own on the bus: Linux SocketCAN, or the bench's hub. For the host only.
 *
 *   @LAW@_node can INTERFACE   raw CAN socket, e.g. vcan0, can0
 *   @LAW@_node hub PATH        Unix socket of the hub (railhil bus hub -c PATH)
 *
 * Exit code 0: the run has ended; 2: bad command line, a bus that cannot be opened, or a plant that refuses this
 * export; 3: the bus is gone or silent. On a board the CAN driver takes the place of this file.
 */
#define _POSIX_C_SOURCE 200809L

#include <errno.h>
#include <net/if.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <linux/can.h>
#include <linux/can/raw.h>

#include "@LAW@_mailboxes.h"
#include "railhil_control.h"

enum { EXIT_ENDED = 0, EXIT_USAGE = 2, EXIT_LOST = 3 };
/* Silence that ends the program: at first the other nodes may be started by hand. */
enum { FIRST_FRAME_MS = 60000, SILENCE_MS = 3000, HUB_START_MS = 5000 };
/* A full transmit queue is retried this often, this far apart; then the answer is dropped: a later one is newer. */
enum { SEND_RETRIES = 40, SEND_RETRY_NS = 500000, DOWN_WAIT_NS = 50000000 };
/* Packets of the hub: up to 256 frames, each a struct can_frame, or one CAN FD frame. */
enum { PACKET_FRAMES = 256, FD_PACKET = 72, HELLO_MAX = 1024 };

typedef struct {
    int socket;
    int is_hub;
    const char *channel;
    unsigned long dropped; /* answers that the interface did not take */
    int down;
} bus_t;

static int complain(const char *channel, const char *what, const char *why)
{
    fprintf(stderr, "@LAW@_node: %s: %s: %s\n", channel, what, why);
    return -1;
}

static void pause_ns(long ns)
{
    struct timespec duration;
    duration.tv_sec = 0;
    duration.tv_nsec = ns;
    nanosleep(&duration, NULL);
}

static int64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* A read ends after half a second without a frame. */
static int set_timeout(int fd)
{
    struct timeval timeout;
    timeout.tv_sec = 0;
    timeout.tv_usec = 500000;
    return setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
}

/* The kernel lets in what the receive mailboxes of the chip would. */
static int set_filters(int fd)
{
    struct can_filter filters[RAILHIL_MAILBOX_COUNT];
    socklen_t count = 0;
    unsigned i;
    for (i = 0; i < RAILHIL_MAILBOX_COUNT; i++) {
        const railhil_mailbox_t *box = &railhil_mailboxes[i];
        if (!box->transmit) {
            filters[count].can_id = box->can_id | (box->extended ? CAN_EFF_FLAG : 0u);
            filters[count].can_mask = ~box->mask & (box->extended ? CAN_EFF_MASK : CAN_SFF_MASK);
            filters[count].can_mask |= CAN_EFF_FLAG | CAN_RTR_FLAG;
            count++;
        }
    }
    return setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters, count * (socklen_t)sizeof filters[0]);
}

static int open_can(const char *interface)
{
    struct sockaddr_can address;
    const unsigned index = if_nametoindex(interface);
    const int fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if (fd < 0) {
        return complain(interface, "no CAN in this kernel", strerror(errno));
    }
    memset(&address, 0, sizeof address);
    address.can_family = AF_CAN;
    address.can_ifindex = (int)index;
    if (index == 0 || set_filters(fd) != 0 || set_timeout(fd) != 0 ||
        bind(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        complain(interface, "cannot be opened", strerror(errno));
        close(fd);
        return -1;
    }
    return fd;
}

/* The first packet in each direction is a hello; a refusal has the key "error". */
static int say_hello(int fd, const char *path)
{
    static const char hello[] = "{\"railhil_hub\": 1, \"name\": \"@LAW@_node\", \"receive_own\": false}";
    char answer[HELLO_MAX + 1];
    ssize_t size;
    if (send(fd, hello, sizeof hello - 1, MSG_NOSIGNAL) < 0 || (size = recv(fd, answer, HELLO_MAX, 0)) < 0) {
        return complain(path, "hub", strerror(errno));
    }
    answer[size] = '\0';
    if (strstr(answer, "\"railhil_hub\": 1") == NULL || strstr(answer, "\"error\"") != NULL) {
        return complain(path, "the hub refuses", size == 0 ? "no answer" : answer);
    }
    return 0;
}

/* Waits for a hub that is only just starting. */
static int open_hub(const char *path)
{
    struct sockaddr_un address;
    const int64_t until_ms = now_ms() + HUB_START_MS;
    memset(&address, 0, sizeof address);
    address.sun_family = AF_UNIX;
    if (strlen(path) >= sizeof address.sun_path) {
        return complain(path, "cannot be opened", "the path is too long for a Unix socket");
    }
    strcpy(address.sun_path, path);
    for (;;) {
        const int fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);
        if (fd < 0) {
            return complain(path, "cannot be opened", strerror(errno));
        }
        if (connect(fd, (const struct sockaddr *)&address, sizeof address) == 0) {
            if (say_hello(fd, path) == 0 && set_timeout(fd) == 0) {
                return fd;
            }
            close(fd);
            return -1;
        }
        close(fd);
        if ((errno != ENOENT && errno != ECONNREFUSED) || now_ms() > until_ms) {
            return complain(path, "no hub", strerror(errno));
        }
        pause_ns(DOWN_WAIT_NS);
    }
}

static int is_down(int error)
{
    return error == ENETDOWN || error == ENODEV || error == ENXIO;
}

/* Frames that have come, at most PACKET_FRAMES; 0 after half a second without one, -1 when the bus is gone. */
static int receive(bus_t *bus, struct can_frame *frames)
{
    const ssize_t size = recv(bus->socket, frames, PACKET_FRAMES * sizeof *frames, 0);
    if (size > 0) {
        if (bus->down) {
            bus->down = 0;
            fprintf(stderr, "@LAW@_node: %s is back\n", bus->channel);
        }
        return size == FD_PACKET ? 0 : (int)((size_t)size / sizeof *frames);
    }
    if (size == 0) {
        return complain(bus->channel, "lost", "connection closed by the hub");
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
        return 0;
    }
    if (bus->is_hub || !is_down(errno)) {
        return complain(bus->channel, "lost", strerror(errno));
    }
    /* An interface that comes back is the same one: the socket stays bound to it. */
    if (!bus->down) {
        bus->down = 1;
        fprintf(stderr, "@LAW@_node: %s is down (%s)\n", bus->channel, strerror(errno));
    }
    pause_ns(DOWN_WAIT_NS);
    return 0;
}

/* Sends one answer; -1 when the bus is gone. The hub takes several frames in one packet, a raw socket one at a time. */
static int send_frames(bus_t *bus, const railhil_frame_t *answer, unsigned count)
{
    struct can_frame frames[RAILHIL_FRAMES_MAX];
    const unsigned at_once = bus->is_hub ? count : 1u;
    unsigned i;
    memset(frames, 0, sizeof frames);
    for (i = 0; i < count; i++) {
        frames[i].can_id = answer[i].can_id;
        frames[i].can_dlc = (unsigned char)answer[i].length;
        memcpy(frames[i].data, answer[i].data, sizeof frames[i].data);
    }
    for (i = 0; i < count; i += at_once) {
        int retries = 0;
        while (send(bus->socket, &frames[i], at_once * sizeof frames[0], MSG_NOSIGNAL) < 0) {
            if (errno == EINTR) {
                continue;
            }
            if (bus->is_hub || (errno != ENOBUFS && errno != EAGAIN && !is_down(errno))) {
                return complain(bus->channel, "cannot send", strerror(errno));
            }
            if (is_down(errno) || retries++ >= SEND_RETRIES) {
                bus->dropped++;
                return 0;
            }
            pause_ns(SEND_RETRY_NS);
        }
    }
    return 0;
}

static void say_how_it_went(const bus_t *bus, const railhil_control_t *control)
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

static int serve(bus_t *bus, railhil_control_t *control)
{
    struct can_frame frames[PACKET_FRAMES];
    railhil_frame_t answer[RAILHIL_FRAMES_MAX];
    int64_t heard_ms = now_ms();
    int patience_ms = FIRST_FRAME_MS;
    while (control->ended == 0) {
        const int count = receive(bus, frames);
        int i;
        if (count < 0) {
            return EXIT_LOST;
        }
        for (i = 0; i < count; i++) {
            const unsigned answers =
                railhil_receive(control, frames[i].can_id, frames[i].can_dlc, frames[i].data, answer);
            if (answers != 0 && send_frames(bus, answer, answers) != 0) {
                return EXIT_LOST;
            }
        }
        if (count > 0) {
            heard_ms = now_ms();
            patience_ms = SILENCE_MS;
        } else if (now_ms() - heard_ms > patience_ms) {
            fprintf(stderr, "@LAW@_node: %s: no frame for %d s\n", bus->channel, patience_ms / 1000);
            return EXIT_LOST;
        }
    }
    return control->ended == RAILHIL_REFUSED ? EXIT_USAGE : EXIT_ENDED;
}

int main(int argc, char **argv)
{
    static railhil_control_t control;
    bus_t bus;
    int exit_code;
    if (argc != 3 || (strcmp(argv[1], "can") != 0 && strcmp(argv[1], "hub") != 0)) {
        fprintf(stderr, "@LAW@_node: found %d arguments, allowed can INTERFACE, or hub PATH\n", argc - 1);
        return EXIT_USAGE;
    }
    memset(&bus, 0, sizeof bus);
    bus.is_hub = strcmp(argv[1], "hub") == 0;
    bus.channel = argv[2];
    bus.socket = bus.is_hub ? open_hub(argv[2]) : open_can(argv[2]);
    if (bus.socket < 0) {
        return EXIT_USAGE;
    }
    railhil_init(&control);
    exit_code = serve(&bus, &control);
    if (exit_code == EXIT_USAGE) {
        fprintf(stderr, "@LAW@_node: %s: the plant refuses this export: it was made for another scenario or wire\n",
                bus.channel);
    }
    say_how_it_went(&bus, &control);
    close(bus.socket);
    return exit_code;
}
