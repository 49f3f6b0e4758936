/* The station: B1 counts, LD1 shows that the program runs, and USART3 reports once per second. */
#include "main.h"

#include <stdio.h>

/* USER CODE BEGIN Includes */
#include "turntable.h"
/* USER CODE END Includes */

volatile uint32_t uwTick;
volatile uint32_t presses;

static void SystemClock_Config(void);
static void MX_GPIO_Init(void);
static void MX_USART3_UART_Init(void);

int main(void)
{
    SystemClock_Config();
    SysTick_Config(SystemCoreClock / 1000U);
    NVIC_SetPriority(SysTick_IRQn, 15);
    MX_GPIO_Init();
    MX_USART3_UART_Init();

    /* USER CODE BEGIN 2 */
    const bool started = turntable_start();
    /* USER CODE END 2 */

    uint32_t reported = uwTick;
    while (1) {
        if (uwTick - reported < 1000U) {
            continue;
        }
        reported += 1000U;
        LD1_GPIO_Port->ODR ^= 1U << LD1_Pin;
        printf("pressed %lu times\n", (unsigned long)presses);
        /* USER CODE BEGIN 3 */
        epg_status_t status;
        double position; /* rad, in the newest control cycle */
        if (!started) {
            printf("the controller cannot be started\n");
        } else if (turntable_status(&status) && turntable_get_position(&position)) {
            printf("%ld mrad, %lu cycles\n", (long)(position * 1000.0), (unsigned long)status.statistics.cycles);
        }
        /* USER CODE END 3 */
    }
}

/* The core has 400 MHz, the buses APB1 and APB2 100 MHz, and their timers 200 MHz: PLL1 from the ST-LINK's 8 MHz. */
static void SystemClock_Config(void)
{
    PWR->CR3 = (PWR->CR3 | PWR_CR3_LDOEN) & ~PWR_CR3_BYPASS; /* RM0433, 6.8.4: the first write locks the supply */
    while ((PWR->CSR1 & PWR_CSR1_ACTVOSRDY) == 0U) {
    }
    PWR->D3CR |= PWR_D3CR_VOS; /* VOS1: 6.8.6 */
    while ((PWR->D3CR & PWR_D3CR_VOSRDY) == 0U) {
    }
    RCC->CR |= RCC_CR_HSEBYP;
    RCC->CR |= RCC_CR_HSEON;
    while ((RCC->CR & RCC_CR_HSERDY) == 0U) {
    }
    /* 8.7.11, 8.7.12: 8 MHz / 1 * 100 / 2 = 400 MHz, with an input of 8 to 16 MHz and the wide range of the VCO */
    RCC->PLLCKSELR = (1U << RCC_PLLCKSELR_DIVM1_Pos) | RCC_PLLCKSELR_PLLSRC_HSE;
    RCC->PLLCFGR = (3U << RCC_PLLCFGR_PLL1RGE_Pos) | RCC_PLLCFGR_DIVP1EN;
    RCC->PLL1DIVR = (99U << RCC_PLL1DIVR_N1_Pos) | (1U << RCC_PLL1DIVR_P1_Pos) | (1U << RCC_PLL1DIVR_Q1_Pos) |
                    (1U << RCC_PLL1DIVR_R1_Pos);
    RCC->CR |= RCC_CR_PLL1ON;
    while ((RCC->CR & RCC_CR_PLL1RDY) == 0U) {
    }
    FLASH->ACR = FLASH_ACR_WRHIGHFREQ_1 | FLASH_ACR_LATENCY_2WS; /* table 17: 200 MHz on AXI at VOS1 */
    while ((FLASH->ACR & FLASH_ACR_LATENCY) != FLASH_ACR_LATENCY_2WS) {
    }
    RCC->D1CFGR = RCC_D1CFGR_HPRE_DIV2 | RCC_D1CFGR_D1PPRE_DIV2;
    RCC->D2CFGR = RCC_D2CFGR_D2PPRE1_DIV2 | RCC_D2CFGR_D2PPRE2_DIV2;
    RCC->D3CFGR = RCC_D3CFGR_D3PPRE_DIV2;
    RCC->CFGR = (RCC->CFGR & ~RCC_CFGR_SW) | RCC_CFGR_SW_PLL1;
    while ((RCC->CFGR & RCC_CFGR_SWS) != RCC_CFGR_SWS_PLL1) {
    }
    SystemCoreClock = 400000000U;
}

static void MX_GPIO_Init(void)
{
    RCC->AHB4ENR |= RCC_AHB4ENR_GPIOBEN | RCC_AHB4ENR_GPIOCEN | RCC_AHB4ENR_GPIODEN;
    RCC->APB4ENR |= RCC_APB4ENR_SYSCFGEN;
    (void)RCC->APB4ENR;
    LD1_GPIO_Port->MODER = (LD1_GPIO_Port->MODER & ~(3U << (2U * LD1_Pin))) | (1U << (2U * LD1_Pin));
    B1_GPIO_Port->MODER &= ~(3U << (2U * B1_Pin));
    SYSCFG->EXTICR[3] = (SYSCFG->EXTICR[3] & ~SYSCFG_EXTICR4_EXTI13) | SYSCFG_EXTICR4_EXTI13_PC;
    EXTI->RTSR1 |= 1U << B1_Pin;
    EXTI_D1->IMR1 |= 1U << B1_Pin;
    NVIC_SetPriority(EXTI15_10_IRQn, 5);
    NVIC_EnableIRQ(EXTI15_10_IRQn);
}

/* The serial port of the ST-LINK: PD8 and PD9 with 115200 baud from 100 MHz. */
static void MX_USART3_UART_Init(void)
{
    RCC->APB1LENR |= RCC_APB1LENR_USART3EN;
    (void)RCC->APB1LENR;
    GPIOD->MODER = (GPIOD->MODER & ~(GPIO_MODER_MODE8 | GPIO_MODER_MODE9)) | GPIO_MODER_MODE8_1 | GPIO_MODER_MODE9_1;
    GPIOD->AFR[1] = (GPIOD->AFR[1] & ~(GPIO_AFRH_AFSEL8 | GPIO_AFRH_AFSEL9)) | (7U << GPIO_AFRH_AFSEL8_Pos) |
                    (7U << GPIO_AFRH_AFSEL9_Pos);
    USART3->BRR = 868; /* RM0433, 48.5.4: 100 MHz / 115200 */
    USART3->CR1 = USART_CR1_TE | USART_CR1_RE | USART_CR1_UE;
}

/** Called by the C library for the output of printf(). */
int __io_putchar(int ch)
{
    while ((USART3->ISR & USART_ISR_TXE_TXFNF) == 0U) {
    }
    USART3->TDR = (uint8_t)ch;
    return ch;
}

void Error_Handler(void)
{
    __disable_irq();
    while (1) {
    }
}
