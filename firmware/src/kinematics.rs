//! The serial arm with three revolute joints, in closed form.
//!
//! Yaw q1 turns about the vertical, shoulder q2 lifts the upper arm l1, elbow q3 bends the
//! forearm l2 against it. With reach r = l1 cos q2 + l2 cos(q2 + q3) and
//! height y = l1 sin q2 + l2 sin(q2 + q3), the handle is at (r sin q1, y, r cos q1), from which
//! the home pose is taken away: device space has its origin there, y up, z towards the user.
//!
//! det J = -r l1 l2 sin q3, so the arm is singular stretched or folded (sin q3 = 0) and with the
//! handle above the base (r = 0). The virtual work of a force gives the torques, tau = J^T F
//! (Craig, Introduction to Robotics, 1986).

use cauldron_protocol::{message::Arm, units::NewtonMetres};

use crate::{
    math::{abs, clamp, sin_cos},
    vector::Vec3,
};

/// Below this part of the largest determinant no force is given ...
const SINGULAR: f32 = 0.05;
/// ... and above this one all of it.
const REGULAR: f32 = 0.15;

/// An arm.
#[derive(Clone, Debug)]
pub struct Kinematics {
    upper_m: f32,
    fore_m: f32,
    home_m: Vec3,
}

/// Where the arm stands.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pose {
    /// The handle in device metres.
    pub position_m: Vec3,
    /// Columns of the Jacobian: handle velocity per joint velocity, m/rad.
    pub jacobian: [Vec3; 3],
    /// 1 where forces can be given in every direction, falling to 0 at a singular pose.
    pub regularity: f32,
}

impl Kinematics {
    /// For `arm`.
    #[must_use]
    pub fn new(arm: &Arm) -> Self {
        let [upper, fore] = arm.links;
        let mut kinematics = Self { upper_m: upper.0, fore_m: fore.0, home_m: Vec3::ZERO };
        kinematics.home_m = kinematics.pose(arm.home.map(|h| h.0)).position_m;
        kinematics
    }

    /// Position and Jacobian at joint angles in radians.
    #[must_use]
    pub fn pose(&self, [yaw, shoulder, elbow]: [f32; 3]) -> Pose {
        let (sin_yaw, cos_yaw) = sin_cos(yaw);
        let (sin_upper, cos_upper) = sin_cos(shoulder);
        let (sin_fore, cos_fore) = sin_cos(shoulder + elbow);
        let fore_reach = self.fore_m * cos_fore;
        let fore_height = self.fore_m * sin_fore;
        let reach = self.upper_m * cos_upper + fore_reach;
        let height = self.upper_m * sin_upper + fore_height;
        Pose {
            position_m: Vec3::new(reach * sin_yaw, height, reach * cos_yaw) - self.home_m,
            jacobian: [
                Vec3::new(reach * cos_yaw, 0.0, -(reach * sin_yaw)),
                Vec3::new(-(height * sin_yaw), reach, -(height * cos_yaw)),
                Vec3::new(-(fore_height * sin_yaw), fore_reach, -(fore_height * cos_yaw)),
            ],
            regularity: self.regularity(reach, sin_fore * cos_upper - cos_fore * sin_upper),
        }
    }

    fn regularity(&self, reach: f32, sin_elbow: f32) -> f32 {
        let part = abs(reach * sin_elbow) / (self.upper_m + self.fore_m);
        clamp((part - SINGULAR) / (REGULAR - SINGULAR), 0.0, 1.0)
    }
}

impl Pose {
    /// Joint torques that give `force_n` at the handle.
    #[must_use]
    pub fn torque(&self, force_n: Vec3) -> [NewtonMetres; 3] {
        self.jacobian.map(|column| NewtonMetres(column.dot(force_n)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_4;

    pub(crate) const ARM: Arm = crate::presets::OMNI_LIKE.arm;

    #[test]
    fn home_is_the_origin_and_textbook_poses_are_where_they_should_be() {
        let arm = Kinematics::new(&ARM);
        assert!(arm.pose(ARM.home.map(|h| h.0)).position_m.norm() < 1e-7);
        let home_reach = 0.32 * core::f32::consts::FRAC_1_SQRT_2;
        let stretched = arm.pose([0.0, 0.0, 0.0]);
        assert!((stretched.position_m.z - (0.32 - home_reach)).abs() < 1e-6);
        assert_eq!(stretched.regularity, 0.0);
        let right = arm.pose([2.0 * FRAC_PI_4, 0.0, 2.0 * FRAC_PI_4]).position_m;
        assert!((right.x - 0.16).abs() < 1e-6 && (right.y - 0.16).abs() < 1e-6);
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_position() {
        let arm = Kinematics::new(&ARM);
        for angles in [[0.2, 0.7, -1.4], [-0.5, 0.3, -1.0], [1.1, 1.2, -2.0]] {
            let pose = arm.pose(angles);
            for (joint, column) in pose.jacobian.into_iter().enumerate() {
                let (mut more, mut less) = (angles, angles);
                more[joint] += 1e-2;
                less[joint] -= 1e-2;
                let slope = (arm.pose(more).position_m - arm.pose(less).position_m) * 50.0;
                assert!((slope - column).norm() < 2e-5, "{angles:?} {joint}");
            }
        }
    }

    #[test]
    fn torque_does_the_work_of_the_force() {
        let pose = Kinematics::new(&ARM).pose([0.3, 0.6, -1.3]);
        let force = Vec3::new(1.0, -2.0, 0.5);
        let joint_speed = [0.4, -0.3, 0.9];
        let mut handle_speed = Vec3::ZERO;
        let mut joint_power = 0.0;
        for ((column, speed), torque) in
            pose.jacobian.into_iter().zip(joint_speed).zip(pose.torque(force))
        {
            handle_speed += column * speed;
            joint_power += torque.0 * speed;
        }
        assert!((joint_power - force.dot(handle_speed)).abs() < 1e-6);
    }
}
