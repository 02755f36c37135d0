/* What the files of a board provide for the main loops of this folder (board_start to board_stop), and what these
 * provide for the board. A board with a pipe also has the functions of railhil_pipe.h, one with CAN those at the end.
 */
#ifndef RAILHIL_BOARD_H
#define RAILHIL_BOARD_H

#include "railhil_pipe.h"

/* Clocks, drivers and the counter of time; called once, before anything else. */
void board_start(void);

/* A counter of time that wraps at 32 bits: board.toml has the time of its tick. */
uint32_t board_ticks(void);

/* One line for the console. */
void board_console(const char *line);

/* Ends the emulator; on a real board, waits for a reset. */
void board_stop(void) __attribute__((noreturn));

/* For the handlers of a processor's faults: says what happened and at which address, and stops. */
void board_fault(const char *what, uint32_t address) __attribute__((noreturn));

/* In the main loops: the last words of a controller that cannot go on. */
void board_last_words(const char *line);

/* CAN, standard data frames only. board_can_receive: 1, and the oldest frame that has arrived; 0: none has. It may
 * sleep until an interrupt. board_can_send waits for room. board_can_lost: frames lost in the receiver so far. */
int board_can_receive(railhil_frame_t *frame);
void board_can_send(const railhil_frame_t *frame);
uint32_t board_can_lost(void);

#endif
