#ifndef LAW_H
#define LAW_H

/* Memory of the controller: the average of `size` errors is what it acts on. */
typedef struct {
    double *errors;
    int size;
    int next;
    double integral;
    double rate;
    int saturated;
} law_t;

double law_step(law_t *law, double error, double kp, double ki, double step);

#endif
