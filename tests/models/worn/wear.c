/* State in every place where C has variables.  Nothing resets it. */
static double table[3] = {1.0, 2.0, 3.0};
static double total;
static double *newest = &table[1];
static struct {
    char flag;
    short count;
} odd = {1, 2};
char letters[5] = "abcd";

/* Its value depends on all of the state, and is larger in each call. */
double wear(int unused)
{
    static int calls;
    static double gain = 0.5;

    (void)unused;
    calls++;
    gain *= 1.0625;
    *newest += 0.25;
    newest = &table[calls % 3];
    odd.count++;
    odd.flag = !odd.flag;
    letters[calls % 5]++;
    total += gain + table[0] + table[1] * table[2] + odd.count + odd.flag + letters[1] + letters[4];
    return 1e-3 * total;
}
