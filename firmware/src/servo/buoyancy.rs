//! The damper of what floats. Weight and buoyancy come with the field, as a force by place: a
//! spring, and one that is rendered a tick late gives energy (Colgate & Schenkel 1997: it needs a
//! damper of at least k (T / 2 + delay)). A sphere that bobs makes waves, so it has one.

use cauldron_protocol::message::Buoyancy;

use super::surface::DAMPING_S;
use crate::{field::Medium, vector::Vec3};

/// F = -tau k(y) v, upwards, with k(y) = k (1 - (y/a)^2) the stiffness of a sphere's buoyancy with
/// its centre at the depth y: nothing where it is all under, or out.
pub fn damping_n(
    buoyancy: Buoyancy,
    position_m: Vec3,
    velocity_m_s: Vec3,
    medium: &Medium,
) -> Vec3 {
    let Some(surface) = medium.surface else { return Vec3::ZERO };
    let depth_m = surface.height_m - position_m.y;
    let cut = buoyancy.radius.0 * buoyancy.radius.0 - depth_m * depth_m;
    if cut <= 0.0 {
        return Vec3::ZERO;
    }
    let part = cut / (buoyancy.radius.0 * buoyancy.radius.0);
    Vec3::new(0.0, -DAMPING_S * buoyancy.stiffness.0 * part * velocity_m_s.y, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Surface;
    use cauldron_protocol::units::{Metres, NewtonsPerMetre};

    #[test]
    fn it_resists_as_far_as_the_surface_cuts_the_ball() {
        let ball = Buoyancy { radius: Metres(0.02), stiffness: NewtonsPerMetre(100.0) };
        let surface = Some(Surface { height_m: 0.01, ..Surface::default() });
        let pool = Medium { surface, ..Medium::default() };
        let up = Vec3::new(0.3, 0.1, 0.0);
        let at = |ball, y: f32| damping_n(ball, Vec3::new(0.0, y, 0.0), up, &pool).y;
        assert!((at(ball, 0.01) + 0.1).abs() < 1e-6, "{}", at(ball, 0.01));
        assert!((at(ball, 0.02) + 0.075).abs() < 1e-6, "{}", at(ball, 0.02));
        assert_eq!([at(ball, 0.031), at(ball, -0.011)], [0.0; 2]);
        assert_eq!(at(Buoyancy::default(), 0.01), 0.0);
    }
}
