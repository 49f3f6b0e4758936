/* A user's main(): the target runs twice, each time until a line is read. */
#include <stdio.h>

#include "robot.h"

int main(void)
{
    for (int run = 0; run < 2; run++) {
        char line[80];
        if (!robot_start() || fgets(line, sizeof line, stdin) == NULL) {
            return 1;
        }
        robot_stop();
        puts("stopped");
        fflush(stdout);
        if (fgets(line, sizeof line, stdin) == NULL) {
            return 2;
        }
    }
    return 0;
}
