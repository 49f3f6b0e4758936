typedef struct {
    double speed;
    double target;
    double position;
} controller_inputs_t;

typedef struct {
    double duty;
} controller_outputs_t;

void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs);
