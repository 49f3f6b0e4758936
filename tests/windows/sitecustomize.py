# SPDX-License-Identifier: Apache-2.0
"""Python of Windows reads this at its start under Wine 8, which does not have the function CopyFile2."""

import _winapi

del _winapi.CopyFile2  # type: ignore[attr-defined]  # the module shutil looks for it, and then copies without it
