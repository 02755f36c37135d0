/* Host program around an exported control law: runs recorded inputs through it. For the host only.
 *
 *   @LAW@_run          records on stdin, results on stdout, int32 words in this machine's byte order
 *   @LAW@_run log      records on stdin, the log as text on stdout
 *   @LAW@_run check    a log on stdin: every line is recomputed and compared; exit code 1 at the first difference
 *   @LAW@_run mailboxes   the eCAN mailbox table
 *
 * A record is one control period: flags (bit 0: a run begins here; bit 1: @OTHER@ sent), @RECORD@. A result is: the law's inputs, its state after the period
 * (updated with the @WHAT@ sent), its outputs, the two event counters since the run began. A line of the log is a
 * record and its result, each word as 8 hexadecimal digits; lines that begin with # are comments.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "@LAW@_mailboxes.h"
#include "railhil_result.h"

/* A board that measures control periods names its counter of time here; `check` then prints the ticks of each. */
#ifdef RAILHIL_TICKS
uint32_t RAILHIL_TICKS(void);
#else
#define RAILHIL_TICKS() UINT32_C(0)
#endif

enum { RECORD_WORDS = @RECORD_WORDS@, LINE_WORDS = RECORD_WORDS + RESULT_WORDS, FLAG_BEGIN = 1, FLAG_SENT = 2 };

/* Returns the ticks that it took. */
static uint32_t run(const int32_t *record, result_t *result)
{
    const int begins = (record[0] & FLAG_BEGIN) != 0;
    uint32_t began;
    if (begins) {
        memset(result, 0, sizeof *result);
    }
    began = RAILHIL_TICKS();
    @LAW@_inputs(@GIVEN@, &result->in, &result->events);
    if (begins) {
        @LAW@_start(&result->in, &result->state);
    }
    @LAW@_step(&result->state, &result->in, &result->out, &result->events);
    if ((record[0] & FLAG_SENT) != 0) {
        @LAW@_sent(&result->state, @TOLD@);
    }
    return RAILHIL_TICKS() - began;
}

static int run_records(int as_text)
{
    result_t result;
    int32_t record[RECORD_WORDS];
    uint32_t words[LINE_WORDS];
    size_t got;
    int i;
    memset(&result, 0, sizeof result);
    while ((got = fread(record, 1, sizeof record, stdin)) == sizeof record) {
        run(record, &result);
        if (!as_text) {
            if (fwrite(&result, sizeof result, 1, stdout) != 1) {
                return 2;
            }
            continue;
        }
        memcpy(words, record, sizeof record);
        memcpy(words + RECORD_WORDS, &result, sizeof result);
        for (i = 0; i < LINE_WORDS; i++) {
            printf("%08" PRIX32 "%c", words[i], i + 1 < LINE_WORDS ? ' ' : '\n');
        }
    }
    if (got != 0) {
        fprintf(stderr, "@LAW@_run: %lu bytes left over, a record has %lu\n", (unsigned long)got,
                (unsigned long)sizeof record);
        return 2;
    }
    return fflush(stdout) == 0 ? 0 : 2;
}

/* Reads the words of one line; 1 if the line is complete, 0 at the end of the file, -1 for anything else. */
static int read_line(uint32_t *words, long *line)
{
    int i = 0;
    int c;
    while (i < LINE_WORDS) {
        c = getchar();
        if (c == EOF) {
            return i == 0 ? 0 : -1;
        }
        if (c == '#' && i == 0) {
            while (c != '\n' && c != EOF) {
                c = getchar();
            }
        }
        if (c == '\n') {
            ++*line;
        }
        if (c == '\n' || c == ' ' || c == '\r' || c == EOF) {
            continue;
        }
        ungetc(c, stdin);
        if (scanf("%8" SCNx32, &words[i]) != 1) {
            return -1;
        }
        i++;
    }
    return 1;
}

static int check_log(void)
{
    result_t result;
    int32_t record[RECORD_WORDS];
    uint32_t words[LINE_WORDS];
    uint32_t found;
    long line = 1;
    long steps = 0;
    uint32_t ticks;
    int i;
    int got;
    memset(&result, 0, sizeof result);
    while ((got = read_line(words, &line)) == 1) {
        memcpy(record, words, sizeof record);
        ticks = run(record, &result);
        if (ticks != 0) {
            printf("ticks %" PRIu32 "\n", ticks);
        }
        for (i = RECORD_WORDS; i < LINE_WORDS; i++) {
            memcpy(&found, (const char *)&result + (size_t)(i - RECORD_WORDS) * sizeof found, sizeof found);
            if (found != words[i]) {
                printf("line %ld, word %d: %08" PRIX32 " in the log, %08" PRIX32 " here\n", line, i + 1, words[i],
                       found);
                return 1;
            }
        }
        steps++;
    }
    if (got < 0 || steps == 0) {
        fprintf(stderr, "@LAW@_run: line %ld: found no complete line, allowed %d words of 8 hexadecimal digits\n", line,
                (int)LINE_WORDS);
        return 2;
    }
    printf("%ld control periods identical, %d words each\n", steps, (int)RESULT_WORDS);
    return 0;
}

static int print_mailboxes(void)
{
    unsigned i;
    for (i = 0; i < RAILHIL_MAILBOX_COUNT; i++) {
        const railhil_mailbox_t *box = &railhil_mailboxes[i];
        printf("%u 0x%" PRIX32 " 0x%" PRIX32 " %s %u%s%s\n", (unsigned)box->number, box->can_id, box->mask,
               box->transmit ? "transmit" : "receive", (unsigned)box->length, box->overwrite ? "" : " protected",
               box->extended ? " extended" : "");
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 1) {
        return run_records(0);
    }
    if (argc == 2 && strcmp(argv[1], "log") == 0) {
        return run_records(1);
    }
    if (argc == 2 && strcmp(argv[1], "check") == 0) {
        return check_log();
    }
    if (argc == 2 && strcmp(argv[1], "mailboxes") == 0) {
        return print_mailboxes();
    }
    fprintf(stderr, "@LAW@_run: found %s, allowed nothing, log, check or mailboxes\n", argc == 2 ? argv[1] : "several");
    return 2;
}
