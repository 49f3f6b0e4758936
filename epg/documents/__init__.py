# SPDX-License-Identifier: Apache-2.0
"""Files as their authors wrote them, as trees and text with positions, compared with their schemas."""
