from solver.approach.arcs.arcs import Survey, survey_target
from solver.approach.arcs.of_problem import feasible_arcs
from solver.approach.task.frame import ApproachFrame, approach_frame
from solver.approach.task.relaxation import placement
from solver.exceptions import (
    Fault,
    InvalidProblem,
    InvalidRobot,
    RetimingFailed,
    SolverError,
    UnknownEntrant,
    UnknownRobot,
    UnknownScenario,
    UnsupportedKinematics,
)
from solver.frames.point_pairs import PointPair
from solver.frames.registration import Agreement, check_frame, register_frame
from solver.frames.transforms import (
    FrameWarning,
    NamedFrame,
    RigidTransform,
    transform_from_matrix,
    transform_from_quaternion,
)
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics, jacobian, link_transforms
from solver.kinematics.spherical_wrist import InverseSolutions, inverse_kinematics
from solver.kinematics.torque_weights import torque_parts, torque_weights
from solver.methods.registry import METHODS
from solver.motion.timing import time_joint_line
from solver.problem.options import (
    BACKEND_NAMES,
    DEFAULT_POSITION_MARGIN_M,
    FULL_ANSWER,
    FULL_ANSWER_TARGETS,
    INCLUDES,
    METHOD_NAMES,
    MOST_WEIGHT,
    NORMS,
    ORDERS,
    QP_SOLVER_NAMES,
    RANGES,
    WEIGHTS,
    Options,
)
from solver.problem.plan import Plan
from solver.problem.problem import Problem
from solver.problem.solution import (
    INFEASIBLE,
    PLANNED,
    REASON_CODES,
    Approach,
    Arc,
    Nearest,
    Reason,
    Segment,
    SolverReport,
    Trajectory,
    Transfer,
)
from solver.problem.targets import Target, targets_in_base
from solver.problem.thinning import (
    Blossom,
    BlossomBranch,
    PlacedBlossom,
    ThinningSelection,
    select_blossoms,
)
from solver.robots.files import load_robot, parse_robot, robot_names
from solver.robots.model import PRISMATIC, REVOLUTE, Array, Joint, Link, Robot, Tool
from solver.robots.toml_writing import robot_to_toml
from solver.solving.many_targets import plans_together
from solver.solving.retiming import ChosenApproach, retime
from solver.solving.solve import solve
from solver.solving.staged import (
    Choice,
    choice_from_json,
    choice_to_json,
    choose,
    next_reference,
    plan_part,
)
from solver.urdf.reading import robot_from_urdf
from solver.urdf.writing import robot_to_urdf
from solver.verification.verdict import Residual, Verification
from solver.verification.verify import verify, verify_plan

__all__ = [
    "BACKEND_NAMES",
    "DEFAULT_POSITION_MARGIN_M",
    "FULL_ANSWER",
    "FULL_ANSWER_TARGETS",
    "INCLUDES",
    "INFEASIBLE",
    "METHODS",
    "METHOD_NAMES",
    "MOST_WEIGHT",
    "NORMS",
    "ORDERS",
    "PLANNED",
    "PRISMATIC",
    "QP_SOLVER_NAMES",
    "RANGES",
    "REASON_CODES",
    "REVOLUTE",
    "WEIGHTS",
    "Agreement",
    "Approach",
    "ApproachFrame",
    "Arc",
    "Array",
    "Blossom",
    "BlossomBranch",
    "Choice",
    "ChosenApproach",
    "Fault",
    "FrameWarning",
    "InvalidProblem",
    "InvalidRobot",
    "InverseSolutions",
    "Joint",
    "Link",
    "NamedFrame",
    "Nearest",
    "Options",
    "PlacedBlossom",
    "Plan",
    "PointPair",
    "Problem",
    "Reason",
    "Residual",
    "RetimingFailed",
    "RigidTransform",
    "Robot",
    "Segment",
    "SolverError",
    "SolverReport",
    "Survey",
    "Target",
    "ThinningSelection",
    "Tool",
    "Trajectory",
    "Transfer",
    "UnknownEntrant",
    "UnknownRobot",
    "UnknownScenario",
    "UnsupportedKinematics",
    "Verification",
    "approach_frame",
    "check_frame",
    "choice_from_json",
    "choice_to_json",
    "choose",
    "family_of",
    "feasible_arcs",
    "forward_kinematics",
    "inverse_kinematics",
    "jacobian",
    "link_transforms",
    "load_robot",
    "next_reference",
    "parse_robot",
    "placement",
    "plan_part",
    "plans_together",
    "register_frame",
    "retime",
    "robot_from_urdf",
    "robot_names",
    "robot_to_toml",
    "robot_to_urdf",
    "select_blossoms",
    "solve",
    "survey_target",
    "targets_in_base",
    "time_joint_line",
    "torque_parts",
    "torque_weights",
    "transform_from_matrix",
    "transform_from_quaternion",
    "verify",
    "verify_plan",
]
