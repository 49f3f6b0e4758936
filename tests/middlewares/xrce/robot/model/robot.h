/** A model whose outputs are its inputs, and the number of steps since it was initialised. */
typedef struct {
    double reliable, quick, held, zeroed;
} robot_inputs_t;

typedef struct {
    double got_reliable, got_quick, got_held, got_zeroed, cycles, cycles_too;
} robot_outputs_t;

void robot_init(const robot_inputs_t *inputs, robot_outputs_t *outputs);
void robot_step(const robot_inputs_t *inputs, robot_outputs_t *outputs);
