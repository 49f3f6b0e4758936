/* The serial port of the ST-LINK: RM0433, section 48. Bytes wait in two rings. */
#include <stdatomic.h>

#include "main.h"
#include "registers.h"

#define SIZE 512u /* a power of two */
#define CR1_TXEIE (1u << 7)
#define ISR_RXNE (1u << 5)
#define ISR_TXE (1u << 7)

typedef struct ring {
    unsigned char bytes[SIZE];
    atomic_uint put;   /* written by the context that puts bytes */
    atomic_uint taken; /* written by the context that takes them */
} ring_t;

static ring_t received, waiting;

void USART3_IRQHandler(void);

static bool put(ring_t *ring, unsigned char byte)
{
    const unsigned int index = atomic_load(&ring->put);
    if (index - atomic_load(&ring->taken) == SIZE) {
        return false;
    }
    ring->bytes[index % SIZE] = byte;
    atomic_store(&ring->put, index + 1u);
    return true;
}

static bool take(ring_t *ring, unsigned char *byte)
{
    const unsigned int index = atomic_load(&ring->taken);
    if (index == atomic_load(&ring->put)) {
        return false;
    }
    *byte = ring->bytes[index % SIZE];
    atomic_store(&ring->taken, index + 1u);
    return true;
}

void MX_USART3_UART_Init(void)
{
    RCC_APB1LENR |= 1u << 18;
    (void)RCC_APB1LENR;
    USART3->brr = (64000000u + 115200u / 2u) / 115200u;
    USART3->cr1 = 1u << 5 | 1u << 3 | 1u << 2 | 1u << 0; /* RXNEIE, TE, RE, UE */
    pin_function(GPIOD, 8, 7);
    pin_function(GPIOD, 9, 7);
    interrupt_enable(39, 8);
}

void USART3_IRQHandler(void)
{
    unsigned char byte;
    USART3->icr = 0xFu; /* errors of the line, and an overrun */
    if ((USART3->isr & ISR_RXNE) != 0) {
        (void)put(&received, (unsigned char)USART3->rdr);
    }
    if ((USART3->cr1 & CR1_TXEIE) != 0 && (USART3->isr & ISR_TXE) != 0) {
        if (take(&waiting, &byte)) {
            USART3->tdr = byte;
        } else {
            USART3->cr1 &= ~CR1_TXEIE;
        }
    }
}

size_t serial_read(void *data, size_t size)
{
    unsigned char *bytes = data;
    size_t count = 0;
    while (count < size && take(&received, &bytes[count])) {
        count++;
    }
    return count;
}

size_t serial_write(const void *data, size_t size)
{
    const unsigned char *bytes = data;
    size_t count = 0;
    while (count < size && put(&waiting, bytes[count])) {
        count++;
    }
    USART3->cr1 |= CR1_TXEIE;
    return count;
}
