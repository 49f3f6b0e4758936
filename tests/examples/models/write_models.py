#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the models of the examples: ``python tests/examples/models/write_models.py``."""

from __future__ import annotations

from pathlib import Path

from writer import jiwy, relbot, turntable
from writer.c_function import c_function
from writer.cpp_class import cpp_class

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def model_files() -> dict[Path, str]:
    """Every file of every example model, by path below ``examples/``."""
    folders = {
        Path("jiwy/model"): c_function(jiwy.control()),
        Path("jiwy/plant"): c_function(jiwy.plant()),
        Path("relbot/model"): cpp_class(relbot.control()),
        Path("relbot/plant"): cpp_class(relbot.plant()),
        Path("existing_firmware/station/model"): c_function(turntable.control()),
        Path("existing_cubemx_repository/controller/model"): c_function(turntable.control()),
        Path("existing_pico_repository/turntable/model"): c_function(turntable.control()),
        Path("existing_zephyr_application/model"): c_function(turntable.control()),
    }
    return {folder / name: text for folder, files in folders.items() for name, text in files.items()}


def main() -> None:
    for path, text in model_files().items():
        target = EXAMPLES / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
