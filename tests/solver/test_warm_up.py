import subprocess
import sys

import pytest

from solver import Options, Problem, load_robot, robot_names, solve
from solver.warm_up import home_target
from tests.solver.kinematics.arms import ur5


@pytest.mark.parametrize("name", robot_names())
def test_the_warm_up_target_is_planned_on_every_robot(name: str) -> None:
    """One that is refused early would leave kernels uncompiled."""
    robot = load_robot(name)
    options = Options(method="floating_z", samples=360)
    assert solve(Problem(robot, [home_target(robot)], options=options)).planned == 1


def test_it_fits_an_arm_without_a_closed_form() -> None:
    assert solve(Problem(ur5(), [home_target(ur5())])).planned == 1


LOADED = """
import sys
from dataclasses import replace

from numba.core.dispatcher import Dispatcher

from solver import Options, Problem, load_robot, robot_names, solve
from solver.kinematics.families.registry import family_of
from solver.methods.registry import METHODS
from solver.warm_up import home_target, warm_up


def loaded():
    return {
        (kernel.__module__, kernel.__name__): len(kernel.overloads)
        for module in list(sys.modules.values())
        for kernel in vars(module).values()
        if isinstance(kernel, Dispatcher)
    }


warm_up()
before = loaded()
for name in robot_names():
    robot = load_robot(name)
    target = home_target(robot)
    refused = replace(target, id="refused", position_m=(0.0, 0.0, 9.0))
    several = [target, refused]
    problems = [([target], {"method": method, "norm": "l2"}) for method in METHODS]
    problems += [(several, {"order": order}) for order in ("given", "independent")]
    if family_of(robot, robot.tool(robot.default_tool)).has_closed_form:
        several.append(replace(target, id="uncertain", position_std_m=1e-5))
        problems += [(several, {"order": "optimal"})]
        problems += [(several, {"method": "ssas", "certify": True, "include": ("path",)})]
        problems += [(several, {"strike_zone_m": 0.01, "tilt_tolerance_rad": 0.1})]
    for targets, options in problems:
        solve(Problem(robot, targets, options=Options(**options)))
print(sum(count > 0 for count in before.values()))
print(*(kernel for kernel, count in loaded().items() if count != before.get(kernel)))
"""


def test_no_kernel_is_loaded_after_it() -> None:
    """In a process of its own: what other tests loaded would hide what is missing."""
    command = [sys.executable, "-c", LOADED]
    run = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    by_warm_up, afterwards = run.stdout.splitlines()
    assert int(by_warm_up) > 30
    assert afterwards == ""
