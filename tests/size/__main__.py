# SPDX-License-Identifier: Apache-2.0
"""Prints the size of the project beside the limits of ``limits.yaml``: ``python -m tests.size``."""

from tests.size.measure import LIMITS, files, files_alone, functions, real_time, rooms, words

names = files()
found = list(functions(names))
print(f"{'language':<14}{'functions':>9}{'mean':>7}{'> 12':>6}{'> 15':>6}{'> 20':>6}{'most lines':>12}")
for language in LIMITS["complexity"]:
    some = [function for function in found if function.language == language]
    above = "".join(f"{sum(function.complexity > limit for function in some):>6}" for limit in (12, 15, 20))
    mean = sum(function.complexity for function in some) / len(some)
    print(f"{language:<14}{len(some):>9}{mean:>7.2f}{above}{max(function.lines for function in some):>12}")
counted = rooms(names)
print(f"\n{'room':<28}{'lines':>8}{'budget':>8}")
for room, lines in sorted(counted.items()):
    print(f"{room:<28}{lines:>8}{LIMITS['rooms'].get(room, 0):>8}")
print(f"{'together':<28}{sum(counted.values()):>8}{sum(LIMITS['rooms'].values()):>8}")
print(f"{'words of the pages':<28}{words(names):>8}{LIMITS['words']:>8}")
for kind, limit in LIMITS["real_time"].items():
    print(f"{kind + ' in tests':<28}{len(list(real_time(names, kind))):>8}{limit['most']:>8}")
print(f"{'files alone':<28}{files_alone():>8}{LIMITS['files_alone']:>8}")
