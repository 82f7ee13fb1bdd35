"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

CLAIM_HALVINGS: Final = 4
"""How often a displacement margin that the verifier refutes is halved before none is claimed: one
in a thousand is refuted, of large ones."""
