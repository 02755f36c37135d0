/* Main loop of a board that exchanges frames with the bench by two streams of octets. */
#include "railhil_board.h"

void board_console(const char *line)
{
    railhil_pipe_text(line);
}

void board_last_words(const char *line)
{
    railhil_pipe_failure(line);
}

int main(void)
{
    static railhil_control_t control;
    board_start();
    railhil_init(&control);
    railhil_pipe_serve(&control);
    board_stop();
}
