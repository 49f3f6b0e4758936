typedef struct {
    double forward;
    double turn;
    double number;
    double right;
} controller_inputs_t;

typedef struct {
    double left_speed;
    double right_speed;
    double sum;
    double moving;
} controller_outputs_t;

void controller_init(const controller_inputs_t *inputs, controller_outputs_t *outputs);
void controller_step(const controller_inputs_t *inputs, controller_outputs_t *outputs);
