# SPDX-License-Identifier: Apache-2.0
"""The generator: from a model, a target and bindings to the sources of an application.

It imports nothing else of EPG.  All other packages of EPG are annexes that use it.
"""
