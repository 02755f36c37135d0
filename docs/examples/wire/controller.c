/* A train controller written from docs/reference/wire.md, without railhil: cc -std=gnu99 -O2 -o controller controller.c -lm
 * controller can INTERFACE (SocketCAN, such as vcan0), or controller hub PATH (Unix socket of the bench's hub) */
#include <linux/can.h>
#include <math.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
enum { TRN_SPEED = 0x118, TRN_POS = 0x120, TRK_INFO = 0x130, RUN_EVENT = 0x160, PLT_IDENT = 0x168, IDS = 0x800 };
static const double brake = 0.55, traction = 0.8, margin = 0.6, early = 0.3, notches = 5.9, lead = 4.0, gain = 1.0;
static unsigned char blocks[IDS][8], ports[IDS][16]; /* newest block by identifier, newest telegram by address */
static int bus, ticks, counts[IDS];

/* Remainder of x^7+x^6+x^5+x^2+1, even parity over data and remainder, all inverted. */
static unsigned char check(const unsigned char *block, int octets) {
    unsigned remainder = 0, parity = 0;
    for (int bit = 0; bit < 8 * octets; bit++) {
        const unsigned one = block[bit / 8] >> (7 - bit % 8) & 1;
        parity ^= one;
        remainder = (remainder << 1 & 0x7F) ^ ((remainder >> 6 ^ one) & 1 ? 0x65 : 0);
    }
    return (unsigned char)~(remainder << 1 | (parity ^ (unsigned)__builtin_parity(remainder)));
}

/* The last three octets of an answer are those of its poll. F_code 3 is two blocks and a trailer. */
static void answer(const unsigned char *poll, unsigned id, const unsigned char *data) {
    const int f_code = poll[0] >> 4, last = f_code == 3 ? 2 : 0;
    struct can_frame frames[] = {{id, {8}, .data = {0}}, {id + 1, {8}, .data = {0}}, {id + 4, {8}, .data = {0}}};
    unsigned char *end = memcpy(frames[last].data, data, 4);
    end[4] = (unsigned char)(last ? (counts[id] & 15) << 4 | 2 : check(data, f_code == 1 ? 4 : 2));
    for (int k = 0; k < 4 && last; k++) end[k] = k < 2 ? check(memcpy(frames[k].data, data + 8 * k, 8), 8) : 0;
    memcpy(end + 5, poll, 3);
    for (int k = 0; k <= last; k++)
        if (write(bus, &frames[k], sizeof frames[k]) < 0) perror("write");
    counts[id]++;
}

static void respond(const unsigned char *poll, int notch_256th) {
    const int word = poll[0] << 8 | poll[1], life = counts[word & 0x7FF] & 15;
    unsigned char ident[16]; /* as the plant, which knows no law, with the role of a controller */
    memcpy(ident, ports[PLT_IDENT], 16);
    ident[14] = 0x10 | (ident[14] & 15);
    if (word == 0xF001) answer(poll, 0x088, (unsigned char[4]){0x10});
    if (word == 0x3170) answer(poll, 0x170, ident);
    if (word == 0x1110) answer(poll, 0x110, (unsigned char[4]){notch_256th >> 8, notch_256th, 1 << 5, 0x50 | life});
    if (word == 0x3138) answer(poll, 0x138, (unsigned char[16]){[12] = 127 << 1, 31 << 3, 0, 0x60 | life});
}

static double value(int address, int first_bit, int bits, int is_signed) {
    long long raw = 0;
    for (int k = first_bit; k < first_bit + bits; k++) raw = raw << 1 | (ports[address][k / 8] >> (7 - k % 8) & 1);
    return (double)(is_signed && raw >> (bits - 1) ? raw - (1LL << bits) : raw);
}

/* Follow a speed that arrives in time and ends on a parabola at the stopping point. */
static double notch(void) {
    const double left_m = fmax(1e-3 * (value(TRK_INFO, 0, 29, 0) - value(TRN_POS, 0, 32, 1)) - early, 0);
    const double left_s = 0.1 * value(TRK_INFO, 29, 19, 0) - 0.01 * ticks, curve = sqrt(2 * brake * left_m);
    const double cruise = brake * (left_s - sqrt(fmax(left_s * left_s - 2 * left_m / brake, 0)));
    const double target = fmin(fmin(fmax(cruise, 1), 0.004 * value(TRK_INFO, 48, 16, 0) - margin), curve);
    const double wanted = fmin(gain * (target - 1e-4 * value(TRN_SPEED, 0, 24, 1)), traction);
    const double needed = notches * (wanted - brake * (target == curve) + 9.81e-5 * value(TRK_INFO, 96, 16, 1));
    return fmax(-7, fmin(7, needed + lead * (needed - 7 * value(TRN_POS, 32, 16, 1) / 0x4000)));
}

/* Take a frame with 8 octets; returns the address of the telegram that it completes, else 0. */
static int take(int id, const unsigned char *data) {
    const int is_trailer = (id & 7) == 4, address = id & ~7, octets = id == TRN_SPEED ? 4 : 8;
    memcpy(blocks[id], data, 8);
    if ((!is_trailer && octets == 8) || check(data + 5, 2) != data[7]) return 0;
    for (int k = 0; k < (is_trailer ? data[4] & 3 : 1); k++) {
        if (k > 1 || check(blocks[address + k], octets) != data[is_trailer ? k : 4]) return 0;
        memcpy(&ports[address][8 * k], blocks[address + k], 8);
    }
    return address;
}

int main(int argc, char **argv) {
    const char hello[] = "{\"railhil_hub\": 1, \"name\": \"controller.c\", \"role\": \"controller\"}";
    const int is_hub = argc == 3 && strcmp(argv[1], "hub") == 0;
    struct sockaddr_un un = {.sun_family = AF_UNIX};
    struct sockaddr_can can = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(argc == 3 ? argv[2] : "")};
    struct can_frame frames[256];
    snprintf(un.sun_path, sizeof un.sun_path, "%s", argc == 3 ? argv[2] : "");
    bus = is_hub ? socket(AF_UNIX, SOCK_SEQPACKET, 0) : socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if ((is_hub ? connect(bus, (void *)&un, sizeof un) : bind(bus, (void *)&can, sizeof can))) return perror("bus"), 2;
    if (is_hub && (write(bus, hello, sizeof hello - 1) < 0 || read(bus, frames, sizeof frames) <= 0)) return 2;
    for (ssize_t size; (size = read(bus, frames, sizeof frames)) > 0;) {
        for (struct can_frame *one = frames; size % 16 == 0 && one < frames + size / 16; one++) {
            const int is_poll = one->can_id == 0x080 && one->can_dlc == 3 && check(one->data, 2) == one->data[2];
            const int address = one->can_id < IDS && one->can_dlc == 8 ? take((int)one->can_id, one->data) : 0;
            ticks += address == TRN_SPEED ? (one->data[3] - ticks) & 15 : 0; /* its life sign counts ticks of 10 ms */
            if (is_poll) respond(one->data, (int)lrint(256 * notch()));
            if (address == RUN_EVENT && ports[RUN_EVENT][0] >= 4) return 0;
        }
    }
    return 3;
}
