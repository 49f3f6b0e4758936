/* The vector table of the STM32H743 (RM0433, table 150), and the code that runs before main(). */
.syntax unified
.cpu cortex-m7
.fpu softvfp
.thumb

/* An entry of the table.  The program can define the handler; without one, it is Default_Handler. */
.macro vector name
    .word \name
    .weak \name
    .thumb_set \name, Default_Handler
.endm

.section .text.Reset_Handler
.global Reset_Handler
.type Reset_Handler, %function
Reset_Handler:
    ldr r0, =_estack
    mov sp, r0
    bl SystemInit
    ldr r0, =_sdata
    ldr r1, =_edata
    ldr r2, =_sidata
1:  cmp r0, r1
    bcs 2f
    ldr r3, [r2], #4
    str r3, [r0], #4
    b 1b
2:  ldr r0, =_sbss
    ldr r1, =_ebss
    movs r3, #0
3:  cmp r0, r1
    bcs 4f
    str r3, [r0], #4
    b 3b
4:  bl __libc_init_array
    bl main
5:  b 5b
.size Reset_Handler, .-Reset_Handler

.section .text.Default_Handler, "ax", %progbits
.global Default_Handler
.type Default_Handler, %function
Default_Handler:
    b Default_Handler
.size Default_Handler, .-Default_Handler

.section .isr_vector, "a", %progbits
.global g_pfnVectors
.type g_pfnVectors, %object
g_pfnVectors:
    .word _estack
    .word Reset_Handler
    vector NMI_Handler
    vector HardFault_Handler
    vector MemManage_Handler
    vector BusFault_Handler
    vector UsageFault_Handler
    .word 0
    .word 0
    .word 0
    .word 0
    vector SVC_Handler
    vector DebugMon_Handler
    .word 0
    vector PendSV_Handler
    vector SysTick_Handler
    vector WWDG_IRQHandler
    vector PVD_AVD_IRQHandler
    vector TAMP_STAMP_IRQHandler
    vector RTC_WKUP_IRQHandler
    vector FLASH_IRQHandler
    vector RCC_IRQHandler
    vector EXTI0_IRQHandler
    vector EXTI1_IRQHandler
    vector EXTI2_IRQHandler
    vector EXTI3_IRQHandler
    vector EXTI4_IRQHandler
    vector DMA1_Stream0_IRQHandler
    vector DMA1_Stream1_IRQHandler
    vector DMA1_Stream2_IRQHandler
    vector DMA1_Stream3_IRQHandler
    vector DMA1_Stream4_IRQHandler
    vector DMA1_Stream5_IRQHandler
    vector DMA1_Stream6_IRQHandler
    vector ADC_IRQHandler
    vector FDCAN1_IT0_IRQHandler
    vector FDCAN2_IT0_IRQHandler
    vector FDCAN1_IT1_IRQHandler
    vector FDCAN2_IT1_IRQHandler
    vector EXTI9_5_IRQHandler
    vector TIM1_BRK_IRQHandler
    vector TIM1_UP_IRQHandler
    vector TIM1_TRG_COM_IRQHandler
    vector TIM1_CC_IRQHandler
    vector TIM2_IRQHandler
    vector TIM3_IRQHandler
    vector TIM4_IRQHandler
    vector I2C1_EV_IRQHandler
    vector I2C1_ER_IRQHandler
    vector I2C2_EV_IRQHandler
    vector I2C2_ER_IRQHandler
    vector SPI1_IRQHandler
    vector SPI2_IRQHandler
    vector USART1_IRQHandler
    vector USART2_IRQHandler
    vector USART3_IRQHandler
    vector EXTI15_10_IRQHandler
    vector RTC_Alarm_IRQHandler
    .word 0
    vector TIM8_BRK_TIM12_IRQHandler
    vector TIM8_UP_TIM13_IRQHandler
    vector TIM8_TRG_COM_TIM14_IRQHandler
    vector TIM8_CC_IRQHandler
    vector DMA1_Stream7_IRQHandler
    vector FMC_IRQHandler
    vector SDMMC1_IRQHandler
    vector TIM5_IRQHandler
    vector SPI3_IRQHandler
    vector UART4_IRQHandler
    vector UART5_IRQHandler
    vector TIM6_DAC_IRQHandler
    vector TIM7_IRQHandler
    vector DMA2_Stream0_IRQHandler
    vector DMA2_Stream1_IRQHandler
    vector DMA2_Stream2_IRQHandler
    vector DMA2_Stream3_IRQHandler
    vector DMA2_Stream4_IRQHandler
    vector ETH_IRQHandler
    vector ETH_WKUP_IRQHandler
    vector FDCAN_CAL_IRQHandler
    .word 0
    .word 0
    .word 0
    .word 0
    vector DMA2_Stream5_IRQHandler
    vector DMA2_Stream6_IRQHandler
    vector DMA2_Stream7_IRQHandler
    vector USART6_IRQHandler
    vector I2C3_EV_IRQHandler
    vector I2C3_ER_IRQHandler
    vector OTG_HS_EP1_OUT_IRQHandler
    vector OTG_HS_EP1_IN_IRQHandler
    vector OTG_HS_WKUP_IRQHandler
    vector OTG_HS_IRQHandler
    vector DCMI_IRQHandler
    .word 0
    vector RNG_IRQHandler
    vector FPU_IRQHandler
    vector UART7_IRQHandler
    vector UART8_IRQHandler
    vector SPI4_IRQHandler
    vector SPI5_IRQHandler
    vector SPI6_IRQHandler
    vector SAI1_IRQHandler
    vector LTDC_IRQHandler
    vector LTDC_ER_IRQHandler
    vector DMA2D_IRQHandler
    vector SAI2_IRQHandler
    vector QUADSPI_IRQHandler
    vector LPTIM1_IRQHandler
    vector CEC_IRQHandler
    vector I2C4_EV_IRQHandler
    vector I2C4_ER_IRQHandler
    vector SPDIF_RX_IRQHandler
    vector OTG_FS_EP1_OUT_IRQHandler
    vector OTG_FS_EP1_IN_IRQHandler
    vector OTG_FS_WKUP_IRQHandler
    vector OTG_FS_IRQHandler
    vector DMAMUX1_OVR_IRQHandler
    vector HRTIM1_Master_IRQHandler
    vector HRTIM1_TIMA_IRQHandler
    vector HRTIM1_TIMB_IRQHandler
    vector HRTIM1_TIMC_IRQHandler
    vector HRTIM1_TIMD_IRQHandler
    vector HRTIM1_TIME_IRQHandler
    vector HRTIM1_FLT_IRQHandler
    vector DFSDM1_FLT0_IRQHandler
    vector DFSDM1_FLT1_IRQHandler
    vector DFSDM1_FLT2_IRQHandler
    vector DFSDM1_FLT3_IRQHandler
    vector SAI3_IRQHandler
    vector SWPMI1_IRQHandler
    vector TIM15_IRQHandler
    vector TIM16_IRQHandler
    vector TIM17_IRQHandler
    vector MDIOS_WKUP_IRQHandler
    vector MDIOS_IRQHandler
    vector JPEG_IRQHandler
    vector MDMA_IRQHandler
    .word 0
    vector SDMMC2_IRQHandler
    vector HSEM1_IRQHandler
    .word 0
    vector ADC3_IRQHandler
    vector DMAMUX2_OVR_IRQHandler
    vector BDMA_Channel0_IRQHandler
    vector BDMA_Channel1_IRQHandler
    vector BDMA_Channel2_IRQHandler
    vector BDMA_Channel3_IRQHandler
    vector BDMA_Channel4_IRQHandler
    vector BDMA_Channel5_IRQHandler
    vector BDMA_Channel6_IRQHandler
    vector BDMA_Channel7_IRQHandler
    vector COMP_IRQHandler
    vector LPTIM2_IRQHandler
    vector LPTIM3_IRQHandler
    vector LPTIM4_IRQHandler
    vector LPTIM5_IRQHandler
    vector LPUART1_IRQHandler
    .word 0
    vector CRS_IRQHandler
    vector ECC_IRQHandler
    vector SAI4_IRQHandler
    .word 0
    .word 0
    vector WAKEUP_PIN_IRQHandler
.size g_pfnVectors, .-g_pfnVectors
