/* The controller at the end of two streams of octets, one in each direction, instead of a bus: a program of the host, or
 * a board without CAN.
 *
 * A stream is a sequence of records, each one tag and its content:
 *
 *   0x01  frame    identifier (2 octets, high first), length 0..8 (1 octet), data
 *   0x02  end      from the bench, without content: it sends nothing more before the answer. From the controller: end
 *                  of its answer, with 8 octets, little-endian: ticks of the control period that was computed (u32, 0:
 *                  none was), least free stack so far in octets (u32, 0: unknown)
 *   0x03  text     to the bench: length (1 octet), octets; a line of the console
 *   0x04  failure  to the bench: length (1 octet), octets; the controller cannot go on, nothing follows
 */
#ifndef RAILHIL_PIPE_H
#define RAILHIL_PIPE_H

#include <stddef.h>

#include "railhil_control.h"

/* Provided by the program around it: the streams, and how much of the stack was never used (octets, 0: unknown).
 * board_read waits for the bench and returns at least 1 octet and at most most; 0: there is no bench any more. */
size_t board_read(unsigned char *octets, size_t most);
void board_write(const unsigned char *octets, size_t count);
uint32_t board_free_stack(void);

/* Answers the bench until the stream ends. Returns 0, or -1 after a record that the bench does not send. */
int railhil_pipe_serve(railhil_control_t *control);

/* Sends a line of the console, or a failure, at once; at most 255 octets of it. */
void railhil_pipe_text(const char *line);
void railhil_pipe_failure(const char *line);

#endif
