# SPDX-License-Identifier: Apache-2.0
"""Faults that could move a robot, each with the C test that must notice it.

Each file ``<group>.yaml`` of this folder lists the mutants of one group, by the file that they change::

    targets/runtime/src/control/stop.c:
      - fault: a stop does not wait for its cycle
        before: atomic_store(&latch->pending, 1U);
        after: ;
        test: stop/a_stop_disables_in_the_next_cycle

``before`` must fit exactly one place of the file.  White space and comments do not count, so ``before`` is found again
when code moves.  ``test`` is ``stop/...`` for a ``TEST(...)`` of ``stop_tests.c``.

``table`` reads the files, ``programs`` compiles and runs the tests, and ``test_safety`` tries each mutant.
"""
