//! The surface gives, pops, and clings: one damped spring F = k (y - tau v), y the depth of the
//! handle under the surface and v its own velocity upwards. From above it only pushes, up to the
//! break force; then the probe is through and the medium begins. On the way out it only pulls, up
//! to the pull force; then the probe is free.
//!
//! ```text
//!          y > 0              F > break            y < 0
//!   Dry ----------> OnSurface --------> Wet <----------------> Clinging
//!    ^ <----------                        y > WET_AGAIN_M         |
//!    |     y <= 0                                                 |
//!    +------------------------------------------------------------+
//!                      -F > pull, and y < -OUT_M
//! ```
//!
//! Spring and neck begin at y = 0, so they give back no more than was put in, and what they held
//! when they break is not given to the hand at all. The damper takes no notice of the surface's
//! velocity, which is some 30 ms old when it comes: so it can only ever take energy. A stale
//! surface holds nothing: it neither pushes nor pulls.

use crate::{
    field::{Medium, Surface},
    math::clamp,
    vector::Vec3,
};

/// The probe is out again when it is this far above the surface: enough that the ripple of its own
/// plunge does not lift it out and have it pop in once more.
const OUT_M: f32 = 2e-3;

/// A probe that clings is in the medium again when it is this deep: more than a hand trembles.
const WET_AGAIN_M: f32 = 5e-4;

/// Time constant of the contact's damper.
pub const DAMPING_S: f32 = 0.01;

/// How the probe stands to the medium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Contact {
    /// In the air.
    #[default]
    Dry,
    /// Pressing on the surface.
    OnSurface,
    /// In the medium.
    Wet,
    /// Out of it, but not off its surface.
    Clinging,
}

/// Remembers how the probe stood.
#[derive(Clone, Debug, Default)]
pub struct SurfaceContact {
    last: Contact,
}

impl SurfaceContact {
    /// The contact at `position_m`; `felt` if the surface holds the probe at all, `pull_n` its
    /// pull force.
    pub fn update(
        &mut self,
        felt: bool,
        pull_n: f32,
        position_m: Vec3,
        velocity_m_s: Vec3,
        medium: &Medium,
    ) -> Contact {
        self.last = match medium.surface {
            Some(surface) => self.next(felt, pull_n, position_m, velocity_m_s, &surface),
            None if medium.linear_drag_n_s_per_m > 0.0 => Contact::Wet,
            None if medium.quadratic_drag_n_s2_per_m2 > 0.0 => Contact::Wet,
            None => Contact::Dry,
        };
        self.last
    }

    fn next(
        &self,
        felt: bool,
        pull_n: f32,
        position_m: Vec3,
        velocity_m_s: Vec3,
        surface: &Surface,
    ) -> Contact {
        let depth_m = surface.height_m - position_m.y;
        let held = felt && surface.stiffness_n_per_m > 0.0;
        let force_n = spring_n(surface, position_m, velocity_m_s);
        let breaks = !held || force_n > surface.break_force_n;
        let lets_go = depth_m < -OUT_M && (!held || -force_n > pull_n);
        match self.last {
            Contact::Dry | Contact::OnSurface if depth_m <= 0.0 => Contact::Dry,
            Contact::Dry | Contact::OnSurface if breaks => Contact::Wet,
            Contact::Dry | Contact::OnSurface => Contact::OnSurface,
            Contact::Wet | Contact::Clinging if lets_go => Contact::Dry,
            Contact::Wet if depth_m < 0.0 => Contact::Clinging,
            Contact::Clinging if depth_m > WET_AGAIN_M => Contact::Wet,
            as_before => as_before,
        }
    }
}

/// k (y - tau v).
fn spring_n(surface: &Surface, position_m: Vec3, velocity_m_s: Vec3) -> f32 {
    let depth_m = surface.height_m - position_m.y;
    surface.stiffness_n_per_m * (depth_m - DAMPING_S * velocity_m_s.y)
}

/// The force on the hand: a push on the surface, a pull of at most `pull_n` while it clings.
pub fn force_n(
    contact: Contact,
    pull_n: f32,
    position_m: Vec3,
    velocity_m_s: Vec3,
    medium: &Medium,
) -> Vec3 {
    let Some(surface) = medium.surface else { return Vec3::ZERO };
    let force_n = spring_n(&surface, position_m, velocity_m_s);
    let vertical_n = match contact {
        Contact::OnSurface => clamp(force_n, 0.0, f32::MAX),
        Contact::Clinging => -clamp(-force_n, 0.0, pull_n),
        Contact::Dry | Contact::Wet => return Vec3::ZERO,
    };
    Vec3::new(0.0, vertical_n, 0.0)
}

#[cfg(test)]
mod tests;
