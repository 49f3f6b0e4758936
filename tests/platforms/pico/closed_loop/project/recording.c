/**
 * @file
 * Reads the angles that the plant repeats.  The environment variable RECORDING names the file, which has a line with
 * pan and tilt in rad for each control cycle.
 */
#include <stdio.h>
#include <stdlib.h>

extern double recorded_angles[1000000][2];
double recorded_angles[1000000][2];

static void __attribute__((constructor)) read_recording(void)
{
    const char *path = getenv("RECORDING");
    FILE *file = path == NULL ? NULL : fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "RECORDING names no file\n");
        exit(1);
    }
    size_t count = 0;
    double(*angles)[2] = recorded_angles;
    while (count < 1000000 && fscanf(file, "%lf %lf", &angles[count][0], &angles[count][1]) == 2) {
        count++;
    }
    fclose(file);
}
