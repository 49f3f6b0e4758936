/* As many FMUs do: one file that includes the others. */
#include "axes.c"
