from solver.approach.arcs.of_problem import feasible_arcs
from solver.exceptions import (
    Fault,
    InvalidProblem,
    InvalidRobot,
    SolverError,
    UnknownRobot,
    UnsupportedKinematics,
)
from solver.problem.options import Options
from solver.problem.problem import Problem
from solver.problem.solution import (
    Approach,
    Arc,
    Nearest,
    Plan,
    Reason,
    Segment,
    SolverReport,
    Trajectory,
    Transfer,
)
from solver.problem.targets import Target
from solver.problem.thinning import (
    Blossom,
    BlossomBranch,
    PlacedBlossom,
    ThinningSelection,
    select_blossoms,
)
from solver.robots.files import load_robot, parse_robot, robot_names
from solver.robots.model import Joint, Link, Robot, Tool
from solver.robots.toml_writing import robot_to_toml
from solver.solving.solve import solve
from solver.urdf.reading import robot_from_urdf
from solver.urdf.writing import robot_to_urdf
from solver.verification.verdict import Residual, Verification
from solver.verification.verify import verify, verify_plan

__all__ = [
    "Approach",
    "Arc",
    "Blossom",
    "BlossomBranch",
    "Fault",
    "InvalidProblem",
    "InvalidRobot",
    "Joint",
    "Link",
    "Nearest",
    "Options",
    "PlacedBlossom",
    "Plan",
    "Problem",
    "Reason",
    "Residual",
    "Robot",
    "Segment",
    "SolverError",
    "SolverReport",
    "Target",
    "ThinningSelection",
    "Tool",
    "Trajectory",
    "Transfer",
    "UnknownRobot",
    "UnsupportedKinematics",
    "Verification",
    "feasible_arcs",
    "load_robot",
    "parse_robot",
    "robot_from_urdf",
    "robot_names",
    "robot_to_toml",
    "robot_to_urdf",
    "select_blossoms",
    "solve",
    "verify",
    "verify_plan",
]
