# SPDX-License-Identifier: Apache-2.0
"""How much the tests notice: small faults are put into EPG, one at a time, and some test must fail.

``choice`` finds the mutants, which ``python_source`` and ``c_source`` make, ``workshop`` and ``runtime`` try one of
them, ``trial`` many, ``results`` keeps what came out.  ``python -m tests.mutants --help`` says how to run it.
"""
