typedef struct {
    double torque;
} pendulum_inputs_t;

typedef struct {
    double angle;
    double time;
} pendulum_outputs_t;

typedef struct {
    double damping;
    double stiffness;
    double angle;
    double speed;
    double time;
} pendulum_t;

void pendulum_init(pendulum_t *self, const pendulum_inputs_t *inputs, pendulum_outputs_t *outputs);
void pendulum_step(pendulum_t *self, const pendulum_inputs_t *inputs, pendulum_outputs_t *outputs);
