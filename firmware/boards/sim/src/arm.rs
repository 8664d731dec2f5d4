//! The arm as the world moves it: from the handle's place to encoder counts, and from joint
//! torques to the force at the handle. In f64 and with the textbook's trigonometry, so that the
//! firmware's own is checked against something else.

use cauldron_protocol::message::Arm;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// Inverse kinematics and statics of a serial arm.
#[derive(Clone, Debug)]
pub struct ArmModel {
    links_m: [f64; 2],
    home_rad: [f64; 3],
    home_m: DVec3,
    counts_per_rad: [f64; 3],
}

impl ArmModel {
    /// For `arm`.
    #[must_use]
    pub fn new(arm: &Arm) -> Self {
        let mut model = Self {
            links_m: arm.links.map(|l| f64::from(l.0)),
            home_rad: arm.home.map(|h| f64::from(h.0)),
            home_m: DVec3::ZERO,
            counts_per_rad: arm.counts_per_turn.map(|c| f64::from(c) / TAU),
        };
        model.home_m = model.handle_in_base_m(model.home_rad);
        model
    }

    /// Joint angles in radians that put the handle at a place in device metres; of a place out
    /// of reach, those of the nearest place in it.
    #[must_use]
    pub fn joints_rad(&self, handle_m: DVec3) -> [f64; 3] {
        let [upper, fore] = self.links_m;
        let at = handle_m + self.home_m;
        let reach = at.x.hypot(at.z);
        let distance = reach.hypot(at.y).clamp(1e-6, (upper + fore) * (1.0 - 1e-9));
        let cos_elbow = (distance * distance - upper * upper - fore * fore) / (2.0 * upper * fore);
        let elbow = -cos_elbow.clamp(-1.0, 1.0).acos();
        let bend = (fore * elbow.sin()).atan2(upper + fore * elbow.cos());
        [at.x.atan2(at.z), at.y.atan2(reach) - bend, elbow]
    }

    /// Encoder readings at joint angles, before they are rounded to counts.
    #[must_use]
    pub fn readings(&self, joints_rad: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|j| (joints_rad[j] - self.home_rad[j]) * self.counts_per_rad[j])
    }

    /// The force in newtons that joint torques in N m give at the handle; zero at a singular
    /// pose, where it is not defined.
    #[must_use]
    pub fn force_n(&self, joints_rad: [f64; 3], torque_n_m: [f64; 3]) -> DVec3 {
        let transposed = self.jacobian(joints_rad).transpose();
        if transposed.determinant().abs() < 1e-9 {
            return DVec3::ZERO;
        }
        transposed.inverse() * DVec3::from_array(torque_n_m)
    }

    fn handle_in_base_m(&self, [yaw, shoulder, elbow]: [f64; 3]) -> DVec3 {
        let [upper, fore] = self.links_m;
        let reach = upper * shoulder.cos() + fore * (shoulder + elbow).cos();
        let height = upper * shoulder.sin() + fore * (shoulder + elbow).sin();
        DVec3::new(reach * yaw.sin(), height, reach * yaw.cos())
    }

    fn jacobian(&self, [yaw, shoulder, elbow]: [f64; 3]) -> DMat3 {
        let fore = self.links_m[1];
        let at = self.handle_in_base_m([yaw, shoulder, elbow]);
        let lever =
            |height: f64, reach: f64| DVec3::new(-height * yaw.sin(), reach, -height * yaw.cos());
        let (sin_fore, cos_fore) = (shoulder + elbow).sin_cos();
        DMat3::from_cols(
            DVec3::new(at.z, 0.0, -at.x),
            lever(at.y, at.x * yaw.sin() + at.z * yaw.cos()),
            lever(fore * sin_fore, fore * cos_fore),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_firmware::{kinematics::Kinematics, presets::OMNI_LIKE, vector::Vec3};

    const PLACES: [DVec3; 4] = [
        DVec3::ZERO,
        DVec3::new(0.07, -0.05, 0.02),
        DVec3::new(-0.08, 0.04, -0.06),
        DVec3::new(0.0, -0.09, 0.05),
    ];

    #[test]
    fn the_firmware_finds_the_handle_where_the_world_put_it() {
        let model = ArmModel::new(&OMNI_LIKE.arm);
        let kinematics = Kinematics::new(&OMNI_LIKE.arm);
        for place in PLACES {
            let joints = model.joints_rad(place).map(|j| j as f32);
            let found = kinematics.pose(joints).position_m;
            let error =
                DVec3::new(f64::from(found.x), f64::from(found.y), f64::from(found.z)) - place;
            assert!(error.length() < 2e-7, "{place} {error}");
        }
    }

    #[test]
    fn the_torques_of_the_firmware_give_the_force_it_meant() {
        let model = ArmModel::new(&OMNI_LIKE.arm);
        let kinematics = Kinematics::new(&OMNI_LIKE.arm);
        let meant = Vec3::new(0.7, -1.1, 0.4);
        for place in PLACES {
            let joints = model.joints_rad(place);
            let torque = kinematics.pose(joints.map(|j| j as f32)).torque(meant);
            let got = model.force_n(joints, torque.map(|t| f64::from(t.0)));
            assert!((got - DVec3::new(0.7, -1.1, 0.4)).length() < 1e-5, "{place} {got}");
        }
    }

    #[test]
    fn a_place_out_of_reach_is_met_as_far_as_the_arm_goes() {
        let model = ArmModel::new(&OMNI_LIKE.arm);
        let joints = model.joints_rad(DVec3::new(0.0, 0.0, 9.0));
        assert!(joints.iter().all(|j| j.is_finite()));
    }
}
