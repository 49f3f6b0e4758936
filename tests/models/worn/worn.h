/* A model that never resets its state; images for chips show that EPG does. */
#pragma once

double wear(int unused);
void worn_step(const double *u, double *y);
