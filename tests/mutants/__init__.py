# SPDX-License-Identifier: Apache-2.0
"""A measure of the tests: small faults are put into EPG, one at a time, and a test must fail for each of them.

``python_source`` and ``c_source`` make the mutants and ``choice`` selects some.  ``workshop`` and ``runtime`` try one
mutant, ``trial`` many, and ``results`` stores the results.  ``python -m tests.mutants --help`` explains how to run it.
"""
