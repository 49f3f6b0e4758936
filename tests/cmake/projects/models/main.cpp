// The headers also compile as C++.
#include <cstdio>

#include "first.h"
#include "wheels.h"

int main()
{
    wheels_inputs_t inputs{};
    wheels_outputs_t outputs{};
    wheels_init(wheels_instance(0), &inputs, &outputs);
    wheels_terminate(wheels_instance(0), &inputs, &outputs);
    std::printf("%u %u\n", WHEELS_INSTANCES, FIRST_INSTANCES);
}
