# SPDX-License-Identifier: Apache-2.0
"""Turns an application into the text of its generated files, and writes the files.

``outputs.py`` lists all files of a target.  ``application.py`` renders its C: the macros of the component kinds
(``macros.py``) print the parts of each component, and the templates in ``templates/`` print the frame around them.
``views.py`` and ``service.py`` define the data that templates see.  ``model/`` makes the C that gives access to a
model, ``cmake.py`` and ``description.py`` the files for CMake and for other programs.  ``writer.py`` writes.

A template can print only text that has been escaped for its output language: ``text.py`` and ``template.py`` ensure it.
The output depends on the input alone: no time, no absolute path, no order that varies.
"""
