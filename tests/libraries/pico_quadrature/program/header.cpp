// The headers compile as C++, and can be included twice.
#include "epg/pico_quadrature.h"
#include "epg/pico_quadrature_velocity.h"
