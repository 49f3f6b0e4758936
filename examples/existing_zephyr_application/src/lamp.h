#ifndef LAMP_H
#define LAMP_H

/** Makes the station's lamp ready; a negative error number if that is impossible. */
int lamp_start(void);

void lamp_set(int on);

#endif
