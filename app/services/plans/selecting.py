"""Thinning selections from JSON to JSON."""

import orjson

from app.schemas.thinning_selections import ThinningSelectionRequest
from app.services.exceptions import told_as_invalid
from solver import Blossom, BlossomBranch, select_blossoms


def selection_to_json(body: bytes) -> bytes:
    """The answer's body for a body of POST /v1/thinning-selections.

    Raises:
        InvalidRequest: the request makes no sense; no fault repeats what was sent.
    """
    with told_as_invalid():
        request = ThinningSelectionRequest.from_json(body)
        selection = select_blossoms(
            [
                BlossomBranch(
                    branch.id,
                    branch.points_m,
                    [Blossom(blossom.id, blossom.distance_m) for blossom in branch.blossoms],
                )
                for branch in request.branches
            ]
        )
    # orjson writes dataclasses as objects, with the contract's names.
    return orjson.dumps({"targets": selection.targets, "keepers": selection.keepers})
