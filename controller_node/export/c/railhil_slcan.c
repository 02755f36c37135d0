/* The serial line of a CAN adapter with the slcan protocol (LAWICEL): a line for each frame, tIIILDD... and a CR.
 * See railhil_socket.h.
 */
#define _POSIX_C_SOURCE 200809L

#include "railhil_socket.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <termios.h>
#include <unistd.h>

#include "@LAW@_node.h"

/* Octets read at once: at most RAILHIL_PACKET_FRAMES frames. A frame's line: type, identifier, length, data, CR. */
enum { CHUNK = 1024, ID_DIGITS = 3, HEAD = 1 + ID_DIGITS + 1, FRAME_MAX = HEAD + 16 + 1 };
enum { TENTHS_UNTIL_SILENT = 5, RETRY_MS = 1000 };

static const char hexadecimal[] = "0123456789ABCDEF";
/* Bit rates by the number of their command. */
static const long rates[] = {10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000, 1000000};
enum { RATES = sizeof rates / sizeof rates[0] };

static int put(int fd, const char *text, size_t size)
{
    const int64_t until_ms = railhil_now_ms() + RETRY_MS;
    while (size != 0) {
        const ssize_t done = write(fd, text, size);
        if (done < 0 && errno != EINTR && (errno != EAGAIN || railhil_now_ms() > until_ms)) {
            return -1;
        }
        text += done < 0 ? 0 : done;
        size -= done < 0 ? 0 : (size_t)done;
    }
    return 0;
}

int railhil_slcan_open(const char *path)
{
    struct termios line;
    char opening[] = "C\rS0\rO\r";
    size_t rate = 0;
    int fd;
    while (rate < RATES && rates[rate] != RAILHIL_BIT_RATE) {
        rate++;
    }
    if (rate == RATES) {
        errno = EINVAL;
        return -1;
    }
    opening[3] = hexadecimal[rate];
    fd = open(path, O_RDWR | O_NOCTTY);
    if (fd < 0) {
        return -1;
    }
    if (tcgetattr(fd, &line) == 0) {
        line.c_iflag = 0;
        line.c_oflag = 0;
        line.c_lflag = 0;
        line.c_cflag = CS8 | CREAD | CLOCAL;
        line.c_cc[VMIN] = 0;
        line.c_cc[VTIME] = TENTHS_UNTIL_SILENT;
        if (cfsetispeed(&line, B115200) == 0 && cfsetospeed(&line, B115200) == 0 &&
            tcsetattr(fd, TCSANOW, &line) == 0 && put(fd, opening, sizeof opening - 1) == 0) {
            return fd;
        }
    }
    close(fd);
    return -1;
}

/* Value of a hexadecimal digit, -1: it is none. */
static int digit(char c)
{
    const char *found = c == '\0' ? NULL : strchr(hexadecimal, c >= 'a' && c <= 'f' ? c - 'a' + 'A' : c);
    return found == NULL ? -1 : (int)(found - hexadecimal);
}

/* Reads a line; returns 1 if it is a data frame with a standard identifier. Other lines are acknowledgements of the
 * adapter, or frames that no mailbox receives. */
static int read_line(const char *line, unsigned size, struct can_frame *frame)
{
    unsigned i;
    memset(frame, 0, sizeof *frame);
    if (size < HEAD || line[0] != 't' || digit(line[HEAD - 1]) < 0 || digit(line[HEAD - 1]) > CAN_MAX_DLEN) {
        return 0;
    }
    frame->can_dlc = (unsigned char)digit(line[HEAD - 1]);
    if (size < HEAD + 2u * frame->can_dlc) {
        return 0;
    }
    for (i = 1; i < HEAD + 2u * frame->can_dlc; i++) {
        const int value = digit(line[i]);
        if (value < 0) {
            return 0;
        }
        if (i <= ID_DIGITS) {
            frame->can_id = frame->can_id << 4 | (unsigned)value;
        } else if (i >= HEAD) {
            unsigned char *octet = &frame->data[(i - HEAD) / 2];
            *octet = (unsigned char)(*octet << 4 | value);
        }
    }
    return 1;
}

int railhil_slcan_receive(railhil_bus_t *bus, struct can_frame *frames)
{
    char octets[CHUNK];
    ssize_t i;
    int count = 0;
    const ssize_t size = read(bus->socket, octets, sizeof octets);
    if (size < 0 && errno != EINTR && errno != EAGAIN) {
        return -1;
    }
    for (i = 0; i < size; i++) {
        if (octets[i] == '\r' || octets[i] == '\n' || octets[i] == '\a') {
            count += read_line(bus->line, bus->line_size, &frames[count]);
            bus->line_size = 0;
        } else if (bus->line_size < sizeof bus->line) {
            bus->line[bus->line_size++] = octets[i];
        }
    }
    return count;
}

int railhil_slcan_send(const railhil_bus_t *bus, const railhil_frame_t *answer, unsigned count)
{
    char lines[RAILHIL_FRAMES_MAX * FRAME_MAX];
    size_t size = 0;
    unsigned i;
    unsigned j;
    for (i = 0; i < count; i++) {
        lines[size++] = 't';
        for (j = 0; j < ID_DIGITS; j++) {
            lines[size++] = hexadecimal[answer[i].can_id >> (4 * (ID_DIGITS - 1 - j)) & 0xFu];
        }
        lines[size++] = hexadecimal[answer[i].length];
        for (j = 0; j < 2 * answer[i].length; j++) {
            lines[size++] = hexadecimal[answer[i].data[j / 2] >> (j % 2 != 0 ? 0 : 4) & 0xF];
        }
        lines[size++] = '\r';
    }
    return put(bus->socket, lines, size);
}
