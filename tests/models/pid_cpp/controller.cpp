#include "controller.hpp"

namespace control {

void advance(Filter *filter, const double *u, double *y)
{
    filter->memory[0] += filter->gain * (u[0] - filter->memory[0]);
    filter->memory[1] += filter->gain * (filter->memory[0] - filter->memory[1]);
    y[0] = std::sqrt(std::fabs(filter->memory[1]));
}

} // namespace control
