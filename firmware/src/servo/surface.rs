//! The surface gives like a spring and pops: F = k y, y the depth of the handle under it, until
//! that would exceed the break force; then the probe is through and the medium begins.
//!
//! What the spring held is not given back to the hand when it breaks.

use crate::{field::Medium, vector::Vec3};

/// The probe is out again when it is this far above the surface: enough that the ripple of its own
/// plunge does not lift it out and have it pop in once more.
const OUT_M: f32 = 2e-3;

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
    pub fn update(&mut self, felt: bool, position_m: Vec3, medium: &Medium) -> Contact {
        let Some(surface) = medium.surface else {
            self.through = false;
            let fills_space =
                medium.linear_drag_n_s_per_m > 0.0 || medium.quadratic_drag_n_s2_per_m2 > 0.0;
            return if fills_space { Contact::Wet } else { Contact::Dry };
        };
        let depth_m = surface.height_m - position_m.y;
        let held = felt && surface.stiffness_n_per_m > 0.0; // a stale surface holds nothing up
        let breaks = !held || depth_m * surface.stiffness_n_per_m > surface.break_force_n;
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

/// F = k y, upwards.
pub fn force_n(contact: Contact, position_m: Vec3, medium: &Medium) -> Vec3 {
    match (contact, medium.surface) {
        (Contact::OnSurface, Some(surface)) => {
            let depth_m = surface.height_m - position_m.y;
            Vec3::new(0.0, surface.stiffness_n_per_m * depth_m, 0.0)
        }
        _ => Vec3::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Surface;

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
        assert_eq!(surface.update(true, at(0.02), &medium), Contact::Dry);
        let pressed = surface.update(true, at(0.008), &medium);
        assert_eq!(pressed, Contact::OnSurface);
        assert!((force_n(pressed, at(0.008), &medium).y - 0.8).abs() < 1e-5);
        assert_eq!(surface.update(true, at(0.007), &medium), Contact::Wet);
        assert_eq!(surface.update(true, at(0.0095), &medium), Contact::Wet);
        assert_eq!(surface.update(true, at(0.0118), &medium), Contact::Wet);
        assert_eq!(surface.update(true, at(0.0121), &medium), Contact::Dry);
        assert_eq!(surface.update(true, at(0.0095), &medium), Contact::OnSurface);
    }

    #[test]
    fn a_surface_that_is_not_felt_holds_nothing_up() {
        let mut surface = SurfaceContact::default();
        assert_eq!(surface.update(false, at(0.0099), &over(0.01)), Contact::Wet);
        let faded = over(0.01).surface.map(|s| Surface { stiffness_n_per_m: 0.0, ..s });
        let stale = Medium { surface: faded, ..Medium::default() };
        assert_eq!(SurfaceContact::default().update(true, at(0.0099), &stale), Contact::Wet);
    }

    #[test]
    fn without_a_surface_the_medium_is_everywhere_or_nowhere() {
        let mut surface = SurfaceContact::default();
        let everywhere = Medium { linear_drag_n_s_per_m: 1.0, ..Medium::default() };
        assert_eq!(surface.update(true, at(1.0), &everywhere), Contact::Wet);
        assert_eq!(surface.update(true, at(1.0), &Medium::default()), Contact::Dry);
    }
}
