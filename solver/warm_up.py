"""Compiles the kernels and builds the programmes, so that the first request does not wait.

Run as `python -m solver.warm_up` at set-up; kernels stay compiled on disk.
"""


def warm_up() -> None:
    """Solves one small problem by every method for each shipped robot, in this process."""
    from solver import Options, Problem, Target, load_robot, robot_names, solve
    from solver.registry import METHODS

    for name in robot_names():
        robot = load_robot(name)
        target = Target("warm-up", (0.185, -0.057, 0.42), (-1.0, -1.0, 1.0))
        for method in METHODS:
            for norm in ("l1", "l2"):
                solve(Problem(robot, [target], options=Options(method=method, norm=norm)))
        solve(Problem(robot, [target], options=Options(method="ssas", certify=True)))


if __name__ == "__main__":
    warm_up()
