typedef struct {
    double duty;
} cart_inputs_t;

typedef struct {
    double angle;
    double speed;
    double contact;
} cart_outputs_t;

void cart_step(const cart_inputs_t *inputs, cart_outputs_t *outputs);
