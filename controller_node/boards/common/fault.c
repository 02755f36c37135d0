/* The last words of a board after a fault of its processor. */
#include "railhil_board.h"

void railhil_fail(const char *line)
{
    board_last_words(line);
    board_stop();
}

enum { WHAT_MAX = 64, DIGITS = 8 };

void board_fault(const char *what, uint32_t address)
{
    static const char hexadecimal[] = "0123456789abcdef";
    static char line[WHAT_MAX + 4 + 2 + DIGITS + 1];
    size_t length = 0;
    int i;
    while (length < WHAT_MAX && what[length] != '\0') {
        line[length] = what[length];
        length++;
    }
    memcpy(line + length, " at 0x", 6);
    length += 6;
    for (i = DIGITS - 1; i >= 0; i--) {
        line[length++] = hexadecimal[(address >> (4 * i)) & 0xFu];
    }
    line[length] = '\0';
    board_last_words(line);
    board_stop();
}
