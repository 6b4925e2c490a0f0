"""The DH product and forward kinematics of tables and robots, and the proof that two arms are one."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.kinematics.chain import (
        KinematicChain as KinematicChain,
        angle_error as angle_error,
        axis_rotation as axis_rotation,
        dh_frames as dh_frames,
        dh_transform as dh_transform,
        dh_transform_of as dh_transform_of,
        dh_transforms as dh_transforms,
        forward_kinematics as forward_kinematics,
        joint_motion as joint_motion,
        joint_variables as joint_variables,
        link_poses as link_poses,
        position_error as position_error,
        reach as reach,
        row_transform as row_transform,
        table_chain as table_chain,
    )
    from dh2urdf.kinematics.comparison import usual_tips as usual_tips
    from dh2urdf.kinematics.pose_arrays import pose_matrices as pose_matrices
    from dh2urdf.kinematics.proof import largest_errors as largest_errors
    from dh2urdf.kinematics.walk import CompiledChain as CompiledChain
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "chain": "KinematicChain angle_error axis_rotation dh_frames dh_transform "
            "dh_transform_of dh_transforms forward_kinematics joint_motion "
            "joint_variables link_poses position_error reach row_transform table_chain",
            "comparison": "usual_tips",
            "pose_arrays": "pose_matrices",
            "proof": "largest_errors",
            "walk": "CompiledChain",
        },
    )
