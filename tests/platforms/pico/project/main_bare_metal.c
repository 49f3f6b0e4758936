#include "mischief.h"

int main(void)
{
    if (!CALL(start)()) {
        panic("start");
    }
    for (;;) {
        obey();
    }
}
