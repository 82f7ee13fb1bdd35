import numpy as np
import pytest

from bench.peers import PEERS, Peer, least_efforts, pose_error
from bench.reference import sweep_targets
from bench.targets import random_set


@pytest.mark.parametrize("peer", PEERS.values(), ids=lambda peer: peer.name)
def test_a_peer_has_our_arm_and_its_sweep_is_a_lower_bound(peer: Peer) -> None:
    """Its postures have no cut-in, so they are at most as dear as those that have one."""
    if not peer.installed:
        pytest.skip(f"{peer.name} is in the benchmark's environment only")
    targets = random_set(3, 40)
    problem = targets.problem()
    assert pose_error(peer, problem, 200, seed=1) < 1e-9
    efforts = least_efforts(peer, problem, targets, 50)
    whole = sweep_targets(problem, targets, 50).at_rows
    assert np.isfinite(whole).sum() > 10
    assert np.all(efforts <= whole + 1e-9)
