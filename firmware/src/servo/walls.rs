//! The vessel is solid: a spring pulls the handle to its proxy, the nearest point that the walls
//! allow, and a damper acts against motion into them.

use cauldron_protocol::{Vessel, Wall};

use crate::{math::sqrt, vector::Vec3};

/// What the walls do to the handle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallContact {
    /// Where they allow it to be.
    pub proxy_m: Vec3,
    /// How they push it there.
    pub force_n: Vec3,
}

/// The contact at a position and velocity. The walls are met one after another, each by what the
/// ones before left of the proxy.
pub fn contact(vessel: &Vessel, position_m: Vec3, velocity_m_s: Vec3) -> WallContact {
    let mut proxy_m = position_m;
    for wall in &vessel.walls {
        proxy_m += correction(wall, proxy_m);
    }
    let inward_m = proxy_m - position_m;
    let depth_m = inward_m.norm();
    if depth_m <= 0.0 {
        return WallContact { proxy_m: position_m, force_n: Vec3::ZERO };
    }
    let inward = inward_m * (1.0 / depth_m);
    let outward_m_s = -velocity_m_s.dot(inward);
    let damped_n = if outward_m_s > 0.0 { vessel.damping.0 * outward_m_s } else { 0.0 };
    WallContact { proxy_m, force_n: inward * (vessel.stiffness.0 * depth_m + damped_n) }
}

/// The way from `at_m` to the inner side of a wall, zero if it is there.
fn correction(wall: &Wall, at_m: Vec3) -> Vec3 {
    match *wall {
        Wall::Plane { normal, offset } => {
            let normal = Vec3::from_array(normal);
            let depth_m = offset.0 - normal.dot(at_m);
            if depth_m > 0.0 { normal * depth_m } else { Vec3::ZERO }
        }
        Wall::Pot { centre, radius, rim } => {
            let mut from_axis_m = at_m - Vec3::from(centre);
            if from_axis_m.y > rim.0 {
                return Vec3::ZERO;
            }
            if from_axis_m.y > 0.0 {
                from_axis_m.y = 0.0;
            }
            let squared = from_axis_m.dot(from_axis_m);
            if squared <= radius.0 * radius.0 || squared <= 0.0 {
                return Vec3::ZERO;
            }
            from_axis_m * (radius.0 / sqrt(squared) - 1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_protocol::units::{Metres, NewtonSecondsPerMetre, NewtonsPerMetre};

    fn vessel(walls: &[Wall]) -> Vessel {
        Vessel {
            walls: walls.iter().copied().collect(),
            stiffness: NewtonsPerMetre(500.0),
            damping: NewtonSecondsPerMetre(2.0),
        }
    }

    const FLOOR: Wall = Wall::Plane { normal: [0.0, 1.0, 0.0], offset: Metres(-0.05) };
    const POT: Wall = Wall::Pot {
        centre: [Metres(0.0), Metres(0.0), Metres(0.0)],
        radius: Metres(0.08),
        rim: Metres(0.06),
    };

    #[test]
    fn a_floor_holds_the_proxy_and_pushes_by_depth_and_speed() {
        let at = Vec3::new(0.01, -0.052, 0.0);
        let wall = contact(&vessel(&[FLOOR]), at, Vec3::new(0.3, -0.1, 0.0));
        assert!((wall.proxy_m - Vec3::new(0.01, -0.05, 0.0)).norm() < 1e-7);
        assert!((wall.force_n - Vec3::new(0.0, 500.0 * 0.002 + 0.2, 0.0)).norm() < 1e-4);
        let leaving = contact(&vessel(&[FLOOR]), at, Vec3::new(0.0, 0.1, 0.0));
        assert!((leaving.force_n.y - 1.0).abs() < 1e-4, "no damping on the way out");
    }

    #[test]
    fn a_pot_is_round_below_straight_above_and_open_over_its_rim() {
        let pot = vessel(&[POT]);
        let still = Vec3::ZERO;
        assert_eq!(contact(&pot, Vec3::new(0.05, -0.05, 0.0), still).force_n, still);
        let below = contact(&pot, Vec3::new(0.0, -0.09, 0.0), still);
        assert!((below.proxy_m.y + 0.08).abs() < 1e-6 && below.force_n.y > 4.9);
        let beside = contact(&pot, Vec3::new(0.09, 0.05, 0.0), still);
        assert!((beside.proxy_m - Vec3::new(0.08, 0.05, 0.0)).norm() < 1e-6);
        assert_eq!(contact(&pot, Vec3::new(0.09, 0.07, 0.0), still).force_n, still);
    }
}
