//! The surface gives like a spring and pops: F = k (y - tau v) >= 0, y the depth of the handle
//! under it and v its own velocity upwards, until that exceeds the break force; then the probe is
//! through and the medium begins. The damper takes no notice of the surface's velocity, which is
//! some 30 ms old when it comes: so it can only ever take energy.
//!
//! What the spring held is not given back to the hand when it breaks.

use crate::{
    field::{Medium, Surface},
    vector::Vec3,
};

/// The probe is out again when it is this far above the surface: enough that the ripple of its own
/// plunge does not lift it out and have it pop in once more.
const OUT_M: f32 = 2e-3;

/// Time constant of the contact's damper.
const DAMPING_S: f32 = 0.01;

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
}

/// Remembers whether the probe is through.
#[derive(Clone, Debug, Default)]
pub struct SurfaceContact {
    through: bool,
}

impl SurfaceContact {
    /// The contact at `position_m`; `felt` if the surface holds the probe up at all.
    pub fn update(
        &mut self,
        felt: bool,
        position_m: Vec3,
        velocity_m_s: Vec3,
        medium: &Medium,
    ) -> Contact {
        let Some(surface) = medium.surface else {
            self.through = false;
            let fills_space =
                medium.linear_drag_n_s_per_m > 0.0 || medium.quadratic_drag_n_s2_per_m2 > 0.0;
            return if fills_space { Contact::Wet } else { Contact::Dry };
        };
        let depth_m = surface.height_m - position_m.y;
        let held = felt && surface.stiffness_n_per_m > 0.0; // a stale surface holds nothing up
        let breaks = !held || push_n(&surface, position_m, velocity_m_s) > surface.break_force_n;
        if depth_m < -OUT_M {
            self.through = false;
        } else if depth_m > 0.0 && breaks {
            self.through = true;
        }
        match (self.through, depth_m > 0.0) {
            (true, _) => Contact::Wet,
            (false, true) => Contact::OnSurface,
            (false, false) => Contact::Dry,
        }
    }
}

/// F = k (y - tau v): a surface pushes and never pulls.
fn push_n(surface: &Surface, position_m: Vec3, velocity_m_s: Vec3) -> f32 {
    let depth_m = surface.height_m - position_m.y;
    let push_m = depth_m - DAMPING_S * velocity_m_s.y;
    if push_m > 0.0 { surface.stiffness_n_per_m * push_m } else { 0.0 }
}

/// The force on the hand.
pub fn force_n(contact: Contact, position_m: Vec3, velocity_m_s: Vec3, medium: &Medium) -> Vec3 {
    match (contact, medium.surface) {
        (Contact::OnSurface, Some(surface)) => {
            Vec3::new(0.0, push_n(&surface, position_m, velocity_m_s), 0.0)
        }
        _ => Vec3::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(height_m: f32) -> Medium {
        let surface =
            Surface { height_m, velocity_m_s: 0.0, stiffness_n_per_m: 400.0, break_force_n: 1.0 };
        Medium { surface: Some(surface), linear_drag_n_s_per_m: 1.0, ..Medium::default() }
    }

    fn at(y: f32) -> Vec3 {
        Vec3::new(0.0, y, 0.0)
    }

    #[test]
    fn gives_pops_and_closes_again() {
        let medium = over(0.01);
        let mut surface = SurfaceContact::default();
        assert_eq!(surface.update(true, at(0.02), Vec3::ZERO, &medium), Contact::Dry);
        let pressed = surface.update(true, at(0.008), Vec3::ZERO, &medium);
        assert_eq!(pressed, Contact::OnSurface);
        let force_y_n = |v: f32| force_n(pressed, at(0.008), at(v), &medium).y;
        assert!((force_y_n(0.0) - 0.8).abs() < 1e-5);
        assert!((force_y_n(-0.01) - 0.84).abs() < 1e-5, "sinking costs more");
        assert_eq!(force_y_n(1.0), 0.0, "it never pulls");
        assert_eq!(surface.update(true, at(0.007), Vec3::ZERO, &medium), Contact::Wet);
        assert_eq!(surface.update(true, at(0.0095), Vec3::ZERO, &medium), Contact::Wet);
        assert_eq!(surface.update(true, at(0.0118), Vec3::ZERO, &medium), Contact::Wet);
        assert_eq!(surface.update(true, at(0.0121), Vec3::ZERO, &medium), Contact::Dry);
        assert_eq!(surface.update(true, at(0.0095), Vec3::ZERO, &medium), Contact::OnSurface);
    }

    #[test]
    fn a_surface_that_is_not_felt_holds_nothing_up() {
        let mut surface = SurfaceContact::default();
        assert_eq!(surface.update(false, at(0.0099), Vec3::ZERO, &over(0.01)), Contact::Wet);
        let faded = over(0.01).surface.map(|s| Surface { stiffness_n_per_m: 0.0, ..s });
        let stale = Medium { surface: faded, ..Medium::default() };
        assert_eq!(
            SurfaceContact::default().update(true, at(0.0099), Vec3::ZERO, &stale),
            Contact::Wet
        );
    }

    #[test]
    fn without_a_surface_the_medium_is_everywhere_or_nowhere() {
        let mut surface = SurfaceContact::default();
        let everywhere = Medium { linear_drag_n_s_per_m: 1.0, ..Medium::default() };
        assert_eq!(surface.update(true, at(1.0), Vec3::ZERO, &everywhere), Contact::Wet);
        assert_eq!(surface.update(true, at(1.0), Vec3::ZERO, &Medium::default()), Contact::Dry);
    }
}
