/* The exchange by two streams of octets: see railhil_pipe.h. */
#include "railhil_pipe.h"

enum { FRAME = 1, END = 2, TEXT = 3, FAILURE = 4 };
enum { HEAD = 4, IN_SIZE = 256, OUT_SIZE = 256, TEXT_MAX = 255 };

static unsigned char received[IN_SIZE];
static size_t taken;
static size_t filled;

/* The answer so far; it is written as a whole, unless it is long. */
static unsigned char answer[OUT_SIZE];
static size_t written;

/* The next octet of the bench, -1: the stream has ended. */
static int next(void)
{
    if (taken == filled) {
        taken = 0;
        filled = board_read(received, sizeof received);
        if (filled == 0) {
            return -1;
        }
    }
    return received[taken++];
}

static void flush(void)
{
    if (written != 0) {
        board_write(answer, written);
        written = 0;
    }
}

static void put(const unsigned char *octets, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++) {
        if (written == sizeof answer) {
            flush();
        }
        answer[written++] = octets[i];
    }
}

static void put_frame(const railhil_frame_t *frame)
{
    unsigned char head[HEAD] = {FRAME};
    railhil_put16(head + 1, frame->can_id);
    head[3] = (unsigned char)frame->length;
    put(head, sizeof head);
    put(frame->data, frame->length);
}

static void put_end(uint32_t ticks)
{
    const uint32_t words[2] = {ticks, board_free_stack()};
    unsigned char record[1 + 8] = {END};
    unsigned i;
    for (i = 0; i < 8; i++) {
        record[1 + i] = (unsigned char)((words[i / 4] >> (8 * (i % 4))) & 0xFFu);
    }
    put(record, sizeof record);
    flush();
}

static void put_line(unsigned char tag, const char *line)
{
    unsigned char head[2];
    size_t length = 0;
    while (length < TEXT_MAX && line[length] != '\0') {
        length++;
    }
    head[0] = tag;
    head[1] = (unsigned char)length;
    put(head, sizeof head);
    put((const unsigned char *)line, length);
    flush();
}

void railhil_pipe_text(const char *line)
{
    put_line(TEXT, line);
}

void railhil_pipe_failure(const char *line)
{
    put_line(FAILURE, line);
}

/* Reads the rest of a frame; returns 0, -1: the stream has ended or the frame is none of the bench. */
static int read_frame(railhil_frame_t *frame)
{
    const int high = next();
    const int low = next();
    const int length = next();
    unsigned i;
    if (length < 0 || length > RAILHIL_BLOCK) {
        return -1;
    }
    frame->can_id = (uint32_t)high << 8 | (uint32_t)low;
    frame->length = (unsigned)length;
    for (i = 0; i < frame->length; i++) {
        const int octet = next();
        if (octet < 0) {
            return -1;
        }
        frame->data[i] = (unsigned char)octet;
    }
    return 0;
}

int railhil_pipe_serve(railhil_control_t *control)
{
    railhil_frame_t frame;
    railhil_frame_t answers[RAILHIL_FRAMES_MAX];
    uint32_t ticks = 0;
    for (;;) {
        const int tag = next();
        if (tag < 0) {
            return 0;
        }
        if (tag == END) {
            put_end(ticks);
            ticks = 0;
        } else if (tag == FRAME && read_frame(&frame) == 0) {
            const uint32_t steps = control->law.steps;
            unsigned i;
            const unsigned count = railhil_receive(control, frame.can_id, frame.length, frame.data, answers);
            ticks = control->law.steps != steps ? control->law.ticks : ticks;
            for (i = 0; i < count; i++) {
                put_frame(&answers[i]);
            }
        } else {
            railhil_pipe_failure("a record that is none of the bench");
            return -1;
        }
    }
}
