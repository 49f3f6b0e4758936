/* What the chip measures of itself. */
#ifndef READINGS_H
#define READINGS_H

void readings_start(void);

/* Of the chip, in degrees Celsius. */
float readings_temperature(void);

#endif
