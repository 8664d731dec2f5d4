//! How the liquid moves at first.

use glam::DVec3;

use super::Scene;
use crate::{
    grid::Grid,
    solver::{Solver, flow::Flow},
    surface::Surface,
};

/// How the liquid moves at first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// Not at all.
    Rest,
    /// As the vortex of Taylor & Green (1937) that fits into the box, with this largest speed in
    /// m/s.
    TaylorGreen(f32),
    /// Around the vertical through the middle of the box, under a surface that dips as it has to.
    Whirl(Whirl),
}

impl Scene {
    /// Sets the liquid going as it moves at first, and its surface with it.
    pub(crate) fn start(&self, flow: &mut Flow, surface: Option<&mut Surface>) {
        match self.start {
            Start::Rest => {}
            Start::TaylorGreen(speed_m_s) => {
                set_velocity(flow, &vortex(&self.grid, f64::from(speed_m_s)));
            }
            Start::Whirl(whirl) => {
                let Grid { origin_in_world_m: origin_m, .. } = self.grid;
                let middle_m = (origin_m + 0.5 * self.grid.extent_m()).as_dvec3();
                set_velocity(flow, &|at| whirl.velocity_m_s((at - middle_m).with_y(0.0)));
                if let Some((surface, liquid)) = surface.zip(self.liquid) {
                    let gravity_m_s2 = f64::from(liquid.gravity_m_s2);
                    let from_axis_m = |x: f32, z: f32| {
                        (f64::from(x) - middle_m.x).hypot(f64::from(z) - middle_m.z)
                    };
                    let dip_m = |x, z| whirl.height_m(from_axis_m(x, z), gravity_m_s2) as f32;
                    surface.set(dip_m, |_, _| 0.0);
                }
            }
        }
    }
}

/// What of it keeps its volume; a velocity that is refused leaves the liquid at rest.
fn set_velocity(flow: &mut Flow, velocity_m_s: &dyn Fn(DVec3) -> DVec3) {
    if flow.set_velocity(velocity_m_s).is_ok() {
        flow.project();
    }
}

/// u = U (sin kx cos ly, -(k/l) cos kx sin ly, 0) with half a wave along each edge of the box.
fn vortex(grid: &Grid, speed_m_s: f64) -> impl Fn(DVec3) -> DVec3 {
    let corner = grid.origin_in_world_m.as_dvec3();
    let extent = grid.extent_m().as_dvec3();
    move |at| {
        let phase = std::f64::consts::PI * (at - corner) / extent;
        let (sx, cx) = phase.x.sin_cos();
        let (sy, cy) = phase.y.sin_cos();
        speed_m_s * DVec3::new(sx * cy, -extent.y / extent.x * cx * sy, 0.0)
    }
}

/// A vortex as Kaufmann (1962) and Scully (1975) draw it: it turns as a solid near its axis, ever
/// more slowly further out, and has no edge.
///
/// ```text
/// v(r) = 2 V r c / (r^2 + c^2)         fastest, V, at r = c
/// h(r) = -2 V^2 c^2 / (g (r^2 + c^2))  since g dh/dr = v^2 / r
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whirl {
    /// V: its fastest speed.
    pub speed_m_s: f32,
    /// c: how far from the axis that is.
    pub core_m: f32,
}

impl Whirl {
    /// Velocity at a place beside the axis.
    #[must_use]
    pub fn velocity_m_s(&self, from_axis_m: DVec3) -> DVec3 {
        let [speed_m_s, core_m] = [self.speed_m_s, self.core_m].map(f64::from);
        let turn_per_s =
            2.0 * speed_m_s * core_m / (from_axis_m.length_squared() + core_m * core_m);
        turn_per_s * DVec3::Y.cross(from_axis_m)
    }

    /// Height of its surface at a distance from the axis, above that far away; 0 without gravity.
    #[must_use]
    pub fn height_m(&self, from_axis_m: f64, gravity_m_s2: f64) -> f64 {
        let [speed_m_s, core_m] = [self.speed_m_s, self.core_m].map(f64::from);
        let squares_m2 = from_axis_m * from_axis_m + core_m * core_m;
        let fall_m2_s2 = 2.0 * (speed_m_s * core_m).powi(2) / squares_m2;
        if gravity_m_s2 > 0.0 { -fall_m2_s2 / gravity_m_s2 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_holds_what_turns() {
        let whirl = Whirl { speed_m_s: 0.4, core_m: 0.03 };
        let fastest_m_s = whirl.velocity_m_s(0.03 * DVec3::Z).length();
        assert!((fastest_m_s - 0.4).abs() < 1e-7);
        for r_m in [0.005, 0.03, 0.1] {
            let slope =
                (whirl.height_m(r_m + 1e-5, 9.81) - whirl.height_m(r_m - 1e-5, 9.81)) / 2e-5;
            let speed_m_s = whirl.velocity_m_s(r_m * DVec3::X).length();
            assert!((9.81 * slope * r_m / speed_m_s.powi(2) - 1.0).abs() < 1e-3, "{r_m}: {slope}");
        }
        assert_eq!(whirl.height_m(0.01, 0.0), 0.0);
    }
}
