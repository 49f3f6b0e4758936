/* A hand-written controller with global variables, for the tests. */
#ifndef GAIN_H
#define GAIN_H
extern double gain;
void gain_step(const double *u, double *y);
#endif
