/* SocketCAN and the bench's hub: see railhil_socket.h. */
#define _POSIX_C_SOURCE 200809L

#include "railhil_socket.h"

#include <errno.h>
#include <net/if.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <linux/can/raw.h>

/* HUB_START_MS: a hub may still be starting. SEND_MS: how long sending is retried while the transmit queue is full; the
 * answer is then dropped, since a newer one follows. In lockstep none follows: this answer is retried, also while the
 * interface is down, for as long as the bench's own nodes retry theirs. */
enum { HUB_START_MS = 5000, SEND_MS = 20, SEND_LOCKSTEP_MS = 30000, SEND_RETRY_NS = 500000, DOWN_WAIT_NS = 50000000 };
/* A packet of the hub is one or more struct can_frame, or one CAN FD frame. */
enum { FD_PACKET = 72, HELLO_MAX = 1024 };

static int complain(const char *channel, const char *what, const char *why)
{
    fprintf(stderr, "@PROGRAM@: %s: %s: %s\n", channel, what, why);
    return -1;
}

static void pause_ns(long ns)
{
    struct timespec duration;
    duration.tv_sec = 0;
    duration.tv_nsec = ns;
    nanosleep(&duration, NULL);
}

int64_t railhil_now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* A read returns after half a second without a frame. */
static int set_timeout(int fd)
{
    struct timeval timeout;
    timeout.tv_sec = 0;
    timeout.tv_usec = 500000;
    return setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
}

/* Filters that pass what the receive mailboxes of the chip would accept. */
static void make_filters(railhil_bus_t *bus)
{
    unsigned i;
    bus->filter_count = 0;
    for (i = 0; i < RAILHIL_MAILBOX_COUNT; i++) {
        const railhil_mailbox_t *box = &railhil_mailboxes[i];
        if (!box->transmit) {
            struct can_filter *filter = &bus->filters[bus->filter_count++];
            filter->can_id = box->can_id | (box->extended ? CAN_EFF_FLAG : 0u);
            filter->can_mask = ~box->mask & (box->extended ? CAN_EFF_MASK : CAN_SFF_MASK);
            filter->can_mask |= CAN_EFF_FLAG | CAN_RTR_FLAG;
        }
    }
}

int railhil_is_let_in(const railhil_bus_t *bus, const struct can_frame *frame)
{
    unsigned i;
    for (i = 0; i < bus->filter_count; i++) {
        if (((frame->can_id ^ bus->filters[i].can_id) & (bus->filters[i].can_mask | CAN_ERR_FLAG)) == 0) {
            return 1;
        }
    }
    return 0;
}

static int open_can(railhil_bus_t *bus)
{
    struct sockaddr_can address;
    const char *interface = bus->channel;
    const socklen_t filters_size = bus->filter_count * (socklen_t)sizeof bus->filters[0];
    const unsigned index = if_nametoindex(interface);
    const int fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if (fd < 0) {
        return complain(interface, "no CAN in this kernel", strerror(errno));
    }
    memset(&address, 0, sizeof address);
    address.can_family = AF_CAN;
    address.can_ifindex = (int)index;
    if (index == 0 || setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, bus->filters, filters_size) != 0 ||
        set_timeout(fd) != 0 || bind(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        complain(interface, "cannot be opened", strerror(errno));
        close(fd);
        return -1;
    }
    bus->index = index;
    return fd;
}

/* The socket survives if the interface is set down and up again; an adapter that is unplugged and plugged in again has
 * a new interface index and needs a new socket. */
static void rejoin(railhil_bus_t *bus)
{
    const unsigned index = if_nametoindex(bus->channel);
    if (index != 0 && index != bus->index) {
        const int fd = open_can(bus);
        if (fd >= 0) {
            close(bus->socket);
            bus->socket = fd;
        }
    }
}

/* The first packet in each direction is a hello; a refusal contains the key "error". */
static int say_hello(int fd, const char *path)
{
    static const char hello[] = "{\"railhil_hub\": 1, \"name\": \"@PROGRAM@\", \"role\": \"controller\"}";
    char answer[HELLO_MAX + 1];
    const int64_t until_ms = railhil_now_ms() + HUB_START_MS;
    ssize_t size;
    if (set_timeout(fd) != 0 || send(fd, hello, sizeof hello - 1, MSG_NOSIGNAL) < 0) {
        return complain(path, "hub", strerror(errno));
    }
    while ((size = recv(fd, answer, HELLO_MAX, 0)) < 0) {
        if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
            return complain(path, "hub", strerror(errno));
        }
        if (railhil_now_ms() > until_ms) {
            return complain(path, "hub", "it takes the connection and does not answer");
        }
    }
    answer[size] = '\0';
    if (strstr(answer, "\"railhil_hub\": 1") == NULL || strstr(answer, "\"error\"") != NULL) {
        return complain(path, "the hub refuses", size == 0 ? "no answer" : answer);
    }
    return 0;
}

/* Waits for a hub that is still starting. */
static int open_hub(const char *path)
{
    struct sockaddr_un address;
    const int64_t until_ms = railhil_now_ms() + HUB_START_MS;
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
            if (say_hello(fd, path) == 0) {
                return fd;
            }
            close(fd);
            return -1;
        }
        close(fd);
        if ((errno != ENOENT && errno != ECONNREFUSED) || railhil_now_ms() > until_ms) {
            return complain(path, "no hub", strerror(errno));
        }
        pause_ns(DOWN_WAIT_NS);
    }
}

static int is_down(int error)
{
    return error == ENETDOWN || error == ENODEV || error == ENXIO;
}

int railhil_bus_receive(railhil_bus_t *bus, struct can_frame *frames)
{
    ssize_t size;
    if (bus->kind == RAILHIL_BUS_SLCAN) {
        const int count = railhil_slcan_receive(bus, frames);
        return count < 0 ? complain(bus->channel, "lost", strerror(errno)) : count;
    }
    size = recv(bus->socket, frames, RAILHIL_PACKET_FRAMES * sizeof *frames, 0);
    if (size > 0) {
        if (bus->down) {
            bus->down = 0;
            fprintf(stderr, "@PROGRAM@: %s is back\n", bus->channel);
        }
        return size == FD_PACKET ? 0 : (int)((size_t)size / sizeof *frames);
    }
    if (size == 0) {
        return complain(bus->channel, "lost", "connection closed by the hub");
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) {
        if (bus->down) {
            rejoin(bus);
        }
        return 0;
    }
    if (bus->kind == RAILHIL_BUS_HUB || !is_down(errno)) {
        return complain(bus->channel, "lost", strerror(errno));
    }
    if (!bus->down) {
        bus->down = 1;
        fprintf(stderr, "@PROGRAM@: %s is down (%s)\n", bus->channel, strerror(errno));
    }
    pause_ns(DOWN_WAIT_NS);
    rejoin(bus);
    return 0;
}

/* The hub accepts several frames in one packet, a raw socket one at a time. */
int railhil_bus_send(railhil_bus_t *bus, const railhil_frame_t *answer, unsigned count, int lockstep)
{
    struct can_frame frames[RAILHIL_FRAMES_MAX];
    const unsigned at_once = bus->kind == RAILHIL_BUS_HUB ? count : 1u;
    const int64_t until_ms = railhil_now_ms() + (lockstep ? bus->lockstep_ms : SEND_MS);
    unsigned i;
    if (bus->kind == RAILHIL_BUS_SLCAN) {
        const int done = railhil_slcan_send(bus, answer, count);
        return done < 0 ? complain(bus->channel, "cannot send", strerror(errno)) : 0;
    }
    memset(frames, 0, sizeof frames);
    for (i = 0; i < count; i++) {
        frames[i].can_id = answer[i].can_id;
        frames[i].can_dlc = (unsigned char)answer[i].length;
        memcpy(frames[i].data, answer[i].data, sizeof frames[i].data);
    }
    for (i = 0; i < count; i += at_once) {
        while (send(bus->socket, &frames[i], at_once * sizeof frames[0], MSG_NOSIGNAL) < 0) {
            const int error = errno;
            if (error == EINTR) {
                continue;
            }
            if (bus->kind == RAILHIL_BUS_HUB || (error != ENOBUFS && error != EAGAIN && !is_down(error))) {
                return complain(bus->channel, "cannot send", strerror(error));
            }
            if ((is_down(error) && !lockstep) || railhil_now_ms() > until_ms) {
                bus->dropped++;
                return 0;
            }
            pause_ns(is_down(error) ? DOWN_WAIT_NS : SEND_RETRY_NS);
        }
    }
    return 0;
}

/* A serial line. */
static int open_slcan(const char *path)
{
    const int fd = railhil_slcan_open(path);
    return fd < 0 ? complain(path, "cannot be opened", strerror(errno)) : fd;
}

int railhil_bus_open(railhil_bus_t *bus, railhil_bus_kind_t kind, const char *channel)
{
    memset(bus, 0, sizeof *bus);
    bus->kind = kind;
    bus->channel = channel;
    bus->lockstep_ms = SEND_LOCKSTEP_MS;
    make_filters(bus);
    bus->socket = kind == RAILHIL_BUS_HUB     ? open_hub(channel)
                  : kind == RAILHIL_BUS_SLCAN ? open_slcan(channel)
                                              : open_can(bus);
    return bus->socket < 0 ? -1 : 0;
}
