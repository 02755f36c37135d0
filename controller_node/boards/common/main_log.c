/* The program of an export that recomputes its reference log, on a board whose C library has the files of the host: the
 * log from standard input, its words about it on standard output. */
#include <stdlib.h>

#define main run_main
#include "railhil_run.c"
#undef main

#include "railhil_board.h"

/* Newlib: the standard files of the host. */
void initialise_monitor_handles(void);

/* Called by exit(); what it does elsewhere is in files that this program is linked without. */
void _fini(void)
{
}

void board_last_words(const char *line)
{
    puts(line);
    fflush(stdout);
}

int main(void)
{
    static char name[] = "run";
    static char check[] = "check";
    char *words[] = {name, check, NULL};
    board_start();
    initialise_monitor_handles();
    exit(freopen("/dev/stdin", "r", stdin) != NULL ? run_main(2, words) : 2);
}
