/* Host program of the exported law @LAW@: recomputes a log from standard input. Exit code 0: every word is equal.
 *
 * A line: 1 for the first control period of a run, 2 if other commands were sent after it, else 0; the readings; the
 * commands sent; then the commands, notes and words of the state that the law must give. All are 8 hexadecimal digits.
 */
#include <stdio.h>
#include <string.h>

#include "@LAW@.h"

#define READINGS @READINGS@
#define COMMANDS @COMMANDS@
#define NOTES @NOTES@
#define STATE ((int)(sizeof(@LAW@_state_t) / sizeof(float)))

static int word(int32_t *into)
{
    unsigned long found;
    if (scanf("%8lx", &found) != 1) {
        return 0;
    }
    *into = (int32_t)(uint32_t)found;
    return 1;
}

static int words(int32_t *into, int count)
{
    for (int i = 0; i < count; i++) {
        if (!word(&into[i])) {
            return 0;
        }
    }
    return 1;
}

int main(void)
{
    static @LAW@_state_t state;
    static int32_t raw[READINGS], told[COMMANDS], found[COMMANDS + NOTES + STATE], wanted[COMMANDS + NOTES + STATE];
    int32_t flag;
    long line = 0;
    while (word(&flag)) {
        line++;
        if (!words(raw, READINGS) || !words(told, COMMANDS) || !words(wanted, COMMANDS + NOTES + STATE)) {
            fprintf(stderr, "line %ld is not complete\n", line);
            return 1;
        }
        if (flag == 1) {
            @LAW@_start(raw, &state);
        }
        @LAW@_step(&state, raw, found, found + COMMANDS);
        if (flag == 2) {
            @LAW@_sent(&state, told);
        }
        memcpy(found + COMMANDS + NOTES, &state, sizeof state);
        for (int i = 0; i < COMMANDS + NOTES + STATE; i++) {
            if (found[i] != wanted[i]) {
                fprintf(stderr, "line %ld, result %d: %08lx, expected %08lx\n", line, i + 1,
                        (unsigned long)(uint32_t)found[i], (unsigned long)(uint32_t)wanted[i]);
                return 1;
            }
        }
    }
    printf("%ld control periods, every word equal\n", line);
    return line ? 0 : 1;
}
