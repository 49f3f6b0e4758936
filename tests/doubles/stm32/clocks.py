# SPDX-License-Identifier: Apache-2.0
"""RCC, PWR, FLASH_ACR and SYSCFG of an STM32H743: the clock tree, as the hardware derives it from registers.

Source: RM0433, 8 (RCC), 6 (PWR), 4.9 (FLASH); DS12110, general operating conditions.
"""

from __future__ import annotations

RCC, PWR, SYSCFG, DBGMCU = 0x58024400, 0x58024800, 0x58000400, 0x5C001000
CR, CRRCR, CFGR, D1CFGR, D2CFGR, D3CFGR = 0x00, 0x08, 0x10, 0x18, 0x1C, 0x20
PLLCKSELR, PLLCFGR, PLL1DIVR, PLL1FRACR, D2CCIP2R = 0x28, 0x2C, 0x30, 0x34, 0x54
BDCR, CSR, RSR = 0x70, 0x74, 0xD0
AHB1RSTR, AHB4RSTR, APB1LRSTR, APB2RSTR = 0x80, 0x88, 0x90, 0x98
AHB1ENR, AHB2ENR, AHB4ENR, APB1LENR, APB2ENR, APB4ENR = 0xD8, 0xDC, 0xE0, 0xE8, 0xF0, 0xF4
PWR_CR1, PWR_CSR1, PWR_CR3, PWR_D3CR, PWRCR = 0x00, 0x04, 0x0C, 0x18, 0x2C
RTCAPBEN, RNGEN, DBP, BDRST = 16, 6, 1 << 8, 1 << 16
VOS_READY, USB33_READY, OVERDRIVE = 1 << 13, 1 << 26, 1
AT_RESET = {CR: 0x83, CFGR: 0, PLLCKSELR: 0x02020200, PLLCFGR: 0x01FF0000, RSR: 0x00FE0000}
AT_RESET |= dict.fromkeys((PLL1DIVR, PLL1DIVR + 8, PLL1DIVR + 16), 0x01010280)
HSI, CSI, HSI48, LSI = 64_000_000, 4_000_000, 48_000_000, 32_000
REVISION_V, REVISION_Y = 0x20036450, 0x10036450
LIMITS = {0: 480, 1: 400, 2: 300, 3: 200}
"""MHz of the core clock by voltage scale; scale 0 exists in revision V only."""
AHB_DIVIDERS = dict(zip(range(8, 16), (2, 4, 8, 16, 64, 128, 256, 512)))


def _prescaler(field: int) -> int:
    """HPRE and D1CPRE."""
    return AHB_DIVIDERS.get(field, 1)


def _apb(field: int) -> int:
    """D2PPRE1 and its like: 0xx is 1, then 2, 4, 8, 16."""
    return 1 << (field & 3) + 1 if field & 4 else 1


class Clocks:
    """``crystal``: the frequency at OSC_IN, which comes from another chip: HSEBYP is necessary."""

    def __init__(self, crystal: int, revision: int) -> None:
        self.crystal = crystal
        self.revision = revision
        self.registers: dict[int, int] = {}
        self.power: dict[int, int] = {}
        self.overdrive = 0
        self.reset(0x00FE0000)

    def reset(self, cause: int) -> None:
        """``cause``: bits of RSR; those of earlier resets stay until RMVF clears them."""
        kept = {BDCR: self.registers.get(BDCR, 0), RSR: self.registers.get(RSR, 0) | cause}
        self.registers = AT_RESET | kept
        self.power = {PWR_D3CR: 0x4000, PWR_CR1: 0xF000C000, PWR_CR3: 0x6}
        self.overdrive = 0

    def lose_power(self, *, battery: bool) -> None:
        """``battery`` keeps the backup domain."""
        self.registers[RSR] = 0
        if not battery:
            self.registers[BDCR] = 0

    def read(self, offset: int) -> int:
        value = self.registers.get(offset, 0)
        if offset == CR:  # an oscillator or PLL that is on is ready
            value = value & ~0x2A02E124 | (value & 0x14001000) << 1 | (value & 0x01000000) << 1 | (value & 1) << 2
            value |= (value & 0x80) << 1 | 0xC000 | (0x20000 if value & 0x50000 == 0x50000 else 0)
            return value | (value & 0x18) << 2 & 0x20
        if offset == CFGR:  # the selected clock is in use
            return value & ~0x38 | (value & 7) << 3
        if offset in (BDCR, CSR):
            return value | (value & 1) << 1
        return value

    def write(self, offset: int, value: int) -> None:
        if offset == RSR:
            if value & 1 << 16:
                self.registers[RSR] = 0
            return
        self.registers[offset] = value

    def read_power(self, offset: int) -> int:
        value = self.power.get(offset, 0)
        if offset in (PWR_CSR1, PWR_D3CR):
            return value | VOS_READY
        if offset == PWR_CR3 and value & 1 << 24:  # USB33DEN
            return value | USB33_READY
        return value

    # The tree ---------------------------------------------------------------------------------------------------------

    def _hsi(self) -> int:
        return HSI >> (self.registers[CR] >> 3 & 3)

    def _hse(self) -> int:
        return self.crystal if self.read(CR) >> 17 & 1 else 0

    def pll(self, number: int, output: str) -> int:
        """Frequency of a PLL's output p, q or r; 0 if it is off."""
        shift = number - 1
        if not self.registers[CR] >> 24 + 2 * shift & 1:
            return 0
        select = self.registers[PLLCKSELR]
        source = (self._hsi(), CSI, self._hse(), 0)[select & 3]
        divider = select >> 4 + 8 * shift & 0x3F
        setting = self.registers[PLLCFGR]
        enabled = setting >> 16 + 3 * shift + "pqr".index(output) & 1
        if not (divider and enabled and source):
            return 0
        dividers = self.registers[PLL1DIVR + 8 * shift]
        multiplier = (dividers & 0x1FF) + 1
        fraction = self.registers.get(PLL1FRACR + 8 * shift, 0) >> 3 if setting >> 4 * shift & 1 else 0
        divide = (dividers >> {"p": 9, "q": 16, "r": 24}[output] & 0x7F) + 1
        return source * (8192 * multiplier + fraction) // (8192 * divider * divide)

    @property
    def system(self) -> int:
        choice = self.registers[CFGR] & 7
        return (self._hsi(), CSI, self._hse(), self.pll(1, "p"))[choice & 3]

    @property
    def core(self) -> int:
        return self.system // _prescaler(self.registers.get(D1CFGR, 0) >> 8 & 0xF)

    @property
    def bus(self) -> int:
        """The clock of AXI and AHB."""
        return self.core // _prescaler(self.registers.get(D1CFGR, 0) & 0xF)

    def peripheral(self, apb: int) -> int:
        """The clock of APB1, APB2 or APB4."""
        register, shift = {1: (D2CFGR, 4), 2: (D2CFGR, 8), 4: (D3CFGR, 4)}[apb]
        return self.bus // _apb(self.registers.get(register, 0) >> shift & 7)

    def timer(self, apb: int) -> int:
        """The clock of the timers at APB1 or APB2 (RM0433, 8.5.6; TIMPRE: 8.7.7)."""
        divider = _apb(self.registers.get(D2CFGR, 0) >> {1: 4, 2: 8}[apb] & 7)
        factor = 4 if self.registers[CFGR] >> 15 & 1 else 2
        return min(self.bus, self.peripheral(apb) * factor) if divider > 1 else self.bus

    def uart(self, apb: int) -> int:
        """The kernel clock of the UARTs at APB1, or of USART1 and USART6 at APB2."""
        choice = self.registers.get(D2CCIP2R, 0) >> {1: 0, 2: 3}[apb] & 7
        return (self.peripheral(apb), self.pll(2, "q"), self.pll(3, "q"), self._hsi(), CSI, 32_768, 0, 0)[choice]

    @property
    def usb(self) -> int:
        """The kernel clock of both USB devices; 0 without it, or without the monitor of the transceivers' supply."""
        choice = self.registers.get(D2CCIP2R, 0) >> 20 & 3
        hsi48 = HSI48 if self.read(CR) >> 13 & 1 else 0
        clock = (0, self.pll(1, "q"), self.pll(3, "q"), hsi48)[choice]
        return clock if self.read_power(PWR_CR3) & USB33_READY else 0

    @property
    def random(self) -> int:
        """The kernel clock of RNG (8.7.21, RNGSEL)."""
        hsi48 = HSI48 if self.read(CR) >> 13 & 1 else 0
        return (hsi48, self.pll(1, "q"), 32_768, LSI)[self.registers.get(D2CCIP2R, 0) >> 8 & 3]

    @property
    def scale(self) -> int:
        """The voltage scale: 0 is the highest voltage."""
        vos = self.power[PWR_D3CR] >> 14 & 3
        scale = {3: 1, 2: 2, 1: 3, 0: 3}[vos]
        return 0 if scale == 1 and self.overdrive and self.revision == REVISION_V else scale

    def check(self) -> None:
        """A program must not exceed the data sheet."""
        limit = LIMITS[self.scale] * 1_000_000
        assert 0 < self.core <= limit, f"a core clock of {self.core} Hz at voltage scale {self.scale}"
        assert self.bus <= limit // 2, f"an AXI clock of {self.bus} Hz at voltage scale {self.scale}"
        for apb in (1, 2, 4):
            assert self.peripheral(apb) <= limit // 4, f"APB{apb}: {self.peripheral(apb)} Hz at scale {self.scale}"

    def enabled(self, register: int, bit: int) -> bool:
        return bool(self.registers.get(register, 0) >> bit & 1)
