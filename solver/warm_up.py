"""Compiles the kernels and builds the programmes, so that the first request does not wait.

Run as `python -m solver.warm_up` at set-up; kernels stay compiled on disk.
"""


def warm_up() -> None:
    """Solves one small problem by every method, and small batches, for each shipped robot."""
    from solver import Options, Problem, Target, load_robot, robot_names, solve
    from solver.registry import METHODS
    from solver.tolerances import EXACT_TARGETS

    for name in robot_names():
        robot = load_robot(name)
        target = Target("warm-up", (0.185, -0.057, 0.42), (-1.0, -1.0, 1.0))
        for method in METHODS:
            for norm in ("l1", "l2"):
                solve(Problem(robot, [target], options=Options(method=method, norm=norm)))
        solve(Problem(robot, [target], options=Options(method="ssas", certify=True)))
        # Few targets are ordered by other kernels than many.
        for count in (2, EXACT_TARGETS + 1):
            targets = [
                Target(str(k), (0.185, -0.057 + 0.002 * k, 0.42), (-1.0, -1.0, 1.0))
                for k in range(count)
            ]
            solve(Problem(robot, targets, options=Options(method="ssas", order="optimal")))


if __name__ == "__main__":
    warm_up()
