typedef struct {
    double duty;
} axis_inputs_t;

typedef struct {
    double angle;
    double speed;
} axis_outputs_t;

void axis_step(const axis_inputs_t *inputs, axis_outputs_t *outputs);
