#ifndef AXES_H
#define AXES_H

#if AXES != 3
#error "the build description defines AXES"
#endif

typedef struct {
    double setpoint[AXES];
    double duty[AXES];
    float gain;
    unsigned char mask;
    bool hold;
    int64_t count;
    double slope;
    int32_t offset;
    double x;
    double rate;
    double next;
} axes_t;

#endif
