#include "mischief.h"

int main(void)
{
    if (!jiwy_start()) {
        panic("jiwy_start");
    }
    for (;;) {
        obey();
    }
}
