// The headers in C++, twice.
#include "epg/pico_quadrature.h"
#include "epg/pico_quadrature_velocity.h"
