# SPDX-License-Identifier: Apache-2.0
"""SDKs and programs of this machine, found as ``targets/tools`` describes them."""
