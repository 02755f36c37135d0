/* Main loop of a board with a CAN controller. Its console says when the board hears the bus, what a control period took,
 * and why the controller cannot go on; the bench reads these lines.
 */
#include "railhil_board.h"

enum { LINE_MAX = 80, DIGITS = 10 };

static char line[LINE_MAX + 1];
static size_t length;

static void put(const char *text)
{
    while (*text != '\0' && length < LINE_MAX) {
        line[length++] = *text++;
    }
}

static void put_number(uint32_t number)
{
    char digits[DIGITS + 1];
    size_t at = DIGITS;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    put(digits + at);
}

static void say(void)
{
    line[length] = '\0';
    length = 0;
    board_console(line);
}

void board_last_words(const char *words)
{
    put("failure: ");
    put(words);
    say();
}

/* A frame that the receiver has lost may have been any: the commands can be wrong from now on. */
static void look_for_loss(void)
{
    if (board_can_lost() != 0) {
        board_last_words("the CAN receiver has lost frames");
        board_stop();
    }
}

int main(void)
{
    static railhil_control_t control;
    static railhil_frame_t answers[RAILHIL_FRAMES_MAX];
    railhil_frame_t frame;
    uint32_t steps = 0;
    board_start();
    railhil_init(&control);
    put("ready");
    say();
    for (;;) {
        unsigned i;
        unsigned count;
        look_for_loss();
        if (!board_can_receive(&frame)) {
            continue;
        }
        count = railhil_receive(&control, frame.can_id, frame.length, frame.data, answers);
        for (i = 0; i < count; i++) {
            board_can_send(&answers[i]);
        }
        if (control.law.steps != steps) {
            steps = control.law.steps;
            put("control period: ");
            put_number(control.law.ticks);
            put(" ticks, stack free: ");
            put_number(board_free_stack());
            put(" octets");
            say();
        }
    }
}
