/* The plain C loop that the transports are measured against: what benchmarks/peer.py does, without Python.
 *
 *   loop echo|near pair FD|hub PATH|tcp HOST:PORT|can INTERFACE FIRST_ID
 *
 * echo sends every frame back until the bus ends. near takes one command per line on standard input and answers
 * with one line of nanoseconds on standard output, "ready" first; see benchmarks/peer.py for commands and frames.
 * hub and tcp speak the protocol of bus/hub/wire.py, pair is one end of an AF_UNIX SEQPACKET pair with the same
 * packets and no hello, can is Linux SocketCAN (CAN_RAW, one frame per system call).
 *
 * C99 and POSIX. Exit code 0: the bus or standard input has ended; 1: one line on standard error says what failed.
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <inttypes.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

enum { MAX_FRAMES = 256, BATCH_FRAMES = 8, WINDOW_BATCHES = 16, MAX_PACKET = MAX_FRAMES * 16, MAX_PINGS = 400 };
enum { ANSWER_S = 20, IDLE_S = 300, MAX_CYCLES = 100000 };

/* One connection. kind: p pair, h hub, t TCP, c CAN. first_id: trips; +1: count; +2: stream. */
static struct {
    char kind;
    int fd;
    canid_t first_id;
    uint8_t in[1 << 16];
    size_t in_size;
} bus;

static void fail(const char *what)
{
    fprintf(stderr, "loop: %s: %s\n", what, errno ? strerror(errno) : "not as expected");
    exit(1);
}

static int64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void set_timeout(double seconds)
{
    struct timeval limit = {(time_t)seconds, (suseconds_t)((seconds - (double)(time_t)seconds) * 1e6)};
    if (setsockopt(bus.fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) < 0) fail("SO_RCVTIMEO");
}

/* --- packets and frames ------------------------------------------------------------------------------- */

static void send_packet(const void *packet, size_t size)
{
    uint8_t out[2 + MAX_PACKET];
    size_t head = bus.kind == 't' ? 2 : 0;
    if (head) {
        out[0] = (uint8_t)(size >> 8);
        out[1] = (uint8_t)size;
    }
    memcpy(out + head, packet, size);
    if (send(bus.fd, out, head + size, MSG_NOSIGNAL) != (ssize_t)(head + size)) fail("send");
}

static void send_frames(const struct can_frame *frames, int count)
{
    if (bus.kind != 'c') {
        send_packet(frames, (size_t)count * sizeof *frames);
        return;
    }
    for (int i = 0; i < count; i++)
        if (write(bus.fd, &frames[i], sizeof *frames) != sizeof *frames) fail("write");
}

/* Bytes of the next packet, 0 when the receive timeout is over; ends the program when the bus has ended. */
static size_t receive_packet(void *packet, size_t limit)
{
    for (;;) {
        size_t size = bus.kind == 't' && bus.in_size >= 2 ? (size_t)(bus.in[0] << 8 | bus.in[1]) : 0;
        if (size && bus.in_size >= 2 + size) {
            if (size > limit) fail("packet too long");
            memcpy(packet, bus.in + 2, size);
            bus.in_size -= 2 + size;
            memmove(bus.in, bus.in + 2 + size, bus.in_size);
            return size;
        }
        ssize_t taken = bus.kind == 't' ? recv(bus.fd, bus.in + bus.in_size, sizeof bus.in - bus.in_size, 0)
                                        : recv(bus.fd, packet, limit, 0);
        if (taken < 0 && errno == EAGAIN) return 0;
        if (taken < 0 && errno == EINTR) continue;
        if (taken == 0 || (taken < 0 && errno == ECONNRESET)) exit(0);
        if (taken < 0) fail("recv");
        if (bus.kind != 't') return (size_t)taken;
        bus.in_size += (size_t)taken;
    }
}

static int receive_frames(struct can_frame *frames)
{
    return (int)(receive_packet(frames, MAX_PACKET) / sizeof *frames);
}

/* --- opening ------------------------------------------------------------------------------------------ */

static void say_hello(void)
{
    static const char hello[] = "{\"railhil_hub\": 1, \"name\": \"C loop\", \"receive_own\": false}";
    char answer[MAX_PACKET];
    send_packet(hello, sizeof hello - 1);
    size_t size = receive_packet(answer, sizeof answer - 1);
    answer[size] = 0;
    errno = 0;
    if (!size || !strstr(answer, "railhil_hub") || strstr(answer, "\"error\"")) fail("hello");
}

static void open_unix(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof address.sun_path) fail("path too long");
    strcpy(address.sun_path, path);
    bus.fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);
    if (bus.fd < 0 || connect(bus.fd, (struct sockaddr *)&address, sizeof address) < 0) fail(path);
}

static void open_tcp(const char *where)
{
    char host[64];
    int port, on = 1;
    struct sockaddr_in address = {.sin_family = AF_INET};
    if (sscanf(where, "%63[^:]:%d", host, &port) != 2 || inet_pton(AF_INET, host, &address.sin_addr) != 1) fail(where);
    address.sin_port = htons((uint16_t)port);
    bus.fd = socket(AF_INET, SOCK_STREAM, 0);
    if (bus.fd < 0 || connect(bus.fd, (struct sockaddr *)&address, sizeof address) < 0) fail(where);
    if (setsockopt(bus.fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on) < 0) fail("TCP_NODELAY");
}

/* The filter lets this pair's frames in and nothing else, as that of benchmarks/peer.py does. */
static void open_can(const char *interface)
{
    struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(interface)};
    struct can_filter filter = {bus.first_id, 0x7F0 | CAN_EFF_FLAG};
    if (!address.can_ifindex) fail(interface);
    bus.fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if (bus.fd < 0 || setsockopt(bus.fd, SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) < 0) fail("CAN_RAW");
    if (bind(bus.fd, (struct sockaddr *)&address, sizeof address) < 0) fail(interface);
}

/* --- the far end -------------------------------------------------------------------------------------- */

static struct can_frame frame_of(canid_t id, uint64_t number)
{
    struct can_frame frame = {.can_id = id, .can_dlc = 8};
    memcpy(frame.data, &number, 8);
    return frame;
}

static void echo(void)
{
    struct can_frame frames[MAX_FRAMES], answers[MAX_FRAMES];
    uint64_t streamed = 0;
    int count;
    set_timeout(IDLE_S);
    while ((count = receive_frames(frames)) > 0) {
        int answered = 0;
        for (int i = 0; i < count; i++) {
            if (frames[i].can_id == bus.first_id + 2) {
                streamed++;
            } else if (frames[i].can_id == bus.first_id + 1) {
                answers[answered++] = frame_of(bus.first_id + 1, streamed);
                streamed = 0;
            } else {
                answers[answered++] = frames[i];
            }
        }
        if (answered) send_frames(answers, answered);
    }
}

/* --- the near end ------------------------------------------------------------------------------------- */

/* One frame there and back; what comes in front of the answer (that to a late ping) is passed over. */
static int64_t trip(canid_t id, uint64_t number, uint64_t expected)
{
    struct can_frame frames[MAX_FRAMES], frame = frame_of(id, number), answer = frame_of(id, expected);
    int64_t start_ns = now_ns();
    send_frames(&frame, 1);
    for (;;) {
        int count = receive_frames(frames);
        int64_t stop_ns = now_ns();
        errno = 0;
        if (!count) fail("no echo");
        for (int i = 0; i < count; i++) {
            if (frames[i].can_id == id && memcmp(frames[i].data, answer.data, 8) == 0) return stop_ns - start_ns;
            if (frames[i].can_id == bus.first_id + 1) fail("frames of the stream were lost");
        }
    }
}

static void wait_for_echo(void)
{
    struct can_frame frames[MAX_FRAMES];
    set_timeout(0.05);
    for (uint64_t number = 0; number < MAX_PINGS; number++) {
        struct can_frame ping = frame_of(bus.first_id, number);
        send_frames(&ping, 1);
        if (receive_frames(frames)) {
            set_timeout(ANSWER_S);
            puts("ready");
            return;
        }
    }
    errno = 0;
    fail("no echo process");
}

static void stream(long windows)
{
    struct can_frame batch[BATCH_FRAMES];
    for (int i = 0; i < BATCH_FRAMES; i++) batch[i] = frame_of(bus.first_id + 2, 0);
    int64_t start_ns = now_ns();
    for (long window = 0; window < windows; window++) {
        for (int i = 0; i < WINDOW_BATCHES; i++) send_frames(batch, BATCH_FRAMES);
        trip(bus.first_id + 1, 0, WINDOW_BATCHES * BATCH_FRAMES);
    }
    printf("%" PRId64 "\n", now_ns() - start_ns);
}

static void pace(long cycles, int64_t period_ns, int64_t phase_ns)
{
    static int64_t late_ns[MAX_CYCLES], answered_ns[MAX_CYCLES];
    errno = 0;
    if (cycles > MAX_CYCLES) fail("too many cycles");
    int64_t start_ns = (now_ns() / period_ns + 2) * period_ns + phase_ns;
    for (long cycle = 0; cycle < cycles; cycle++) {
        int64_t deadline_ns = start_ns + cycle * period_ns;
        struct timespec deadline = {deadline_ns / 1000000000, deadline_ns % 1000000000};
        while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, NULL) == EINTR) { }
        late_ns[cycle] = now_ns() - deadline_ns;
        trip(bus.first_id, (uint64_t)cycle, (uint64_t)cycle);
        answered_ns[cycle] = now_ns() - deadline_ns;
    }
    for (long cycle = 0; cycle < cycles; cycle++) printf("%" PRId64 " %" PRId64 " ", late_ns[cycle], answered_ns[cycle]);
    putchar('\n');
}

static void near(void)
{
    char line[128];
    long count, period_ns, phase_ns;
    /* Whole answers: no write between two samples. */
    setvbuf(stdout, NULL, _IOFBF, 1 << 22);
    wait_for_echo();
    fflush(stdout);
    while (fgets(line, sizeof line, stdin)) {
        if (sscanf(line, "trips %ld", &count) == 1) {
            for (long number = 0; number < count; number++)
                printf("%" PRId64 " ", trip(bus.first_id, (uint64_t)number, (uint64_t)number));
            putchar('\n');
        } else if (sscanf(line, "stream %ld", &count) == 1) {
            stream(count);
        } else if (sscanf(line, "pace %ld %ld %ld", &count, &period_ns, &phase_ns) == 3) {
            pace(count, period_ns, phase_ns);
        } else {
            errno = 0;
            fail(line);
        }
        fflush(stdout);
    }
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fputs("usage: loop echo|near pair FD|hub PATH|tcp HOST:PORT|can INTERFACE FIRST_ID\n", stderr);
        return 1;
    }
    bus.kind = argv[2][0];
    bus.first_id = (canid_t)strtoul(argv[4], NULL, 0);
    switch (bus.kind) {
    case 'p': bus.fd = atoi(argv[3]); break;
    case 'h': open_unix(argv[3]); break;
    case 't': open_tcp(argv[3]); break;
    case 'c': open_can(argv[3]); break;
    default: errno = 0; fail(argv[2]);
    }
    if (bus.kind == 'h' || bus.kind == 't') say_hello();
    if (strcmp(argv[1], "echo") == 0) echo();
    else near();
    return 0;
}
