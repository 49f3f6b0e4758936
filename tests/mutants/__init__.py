# SPDX-License-Identifier: Apache-2.0
"""A measure of the tests: small faults (*mutants*) are put into EPG, one at a time, and a test must fail for each.

A mutant replaces a text that occurs once in its file.  ``draw`` makes mutants, ``trial`` runs the tests of their rooms
in copies of the project, and ``record`` stores which test noticed which.  ``rooms.yaml`` lists the tests of each room.
"""
