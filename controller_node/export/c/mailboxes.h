/* @LAW@_mailboxes.h: mailboxes of the eCAN module of a TMS320F28335, made from the port table.
 *
 * can_id: identifier of the frame, 11 bits unless extended; a standard one is in bits 28 to 18 of
 * MSGID. mask: identifier bits that are not compared (1 in LAM); if all are 0, AME stays 0.
 * overwrite: OPC bit clear. All 32 mailboxes exist only in eCAN mode (SCB = 1). The chip has no 8-bit
 * type: the payload is in MDL and MDH, its first byte in the highest bits with DBO = 0.
 */
#ifndef @PREFIX@_MAILBOXES_H
#define @PREFIX@_MAILBOXES_H

#include <stdint.h>

typedef struct {
    uint16_t number;    /* 0..31 */
    uint16_t length;    /* data bytes (DLC) */
    uint16_t transmit;  /* 1 transmit, 0 receive */
    uint16_t overwrite; /* 1: a newer frame replaces an unread one */
    uint16_t extended;  /* 1: 29-bit identifier */
    uint32_t can_id;
    uint32_t mask;
} railhil_mailbox_t;

@NUMBERS@

#define RAILHIL_MAILBOX_COUNT @COUNT@u
static const railhil_mailbox_t railhil_mailboxes[RAILHIL_MAILBOX_COUNT] = {
@ROWS@
};

#endif
