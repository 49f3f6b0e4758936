/* A sin() whose last bit differs from that of this computer's C library. */
#include <math.h>

static double other_sin(double x)
{
    return nextafter(sin(x), 2.0);
}
#define sin other_sin
