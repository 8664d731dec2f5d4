//! What is asked of each step: numbers, energy, and volume.

use glam::Vec3;

use super::{case::Case, world::Liquid};
use crate::{solver::Solver, splash::SplashBooks, surface::Surface, torture::ledger::Ledger};

/// Energy above the account, as a part of it, that is rounding: of a step, as a stiff sheet's
/// energy is told by differences of heights in f32.
const ENERGY_SLACK: f64 = 2e-4;

/// Volume that may be lost or made, as a part of what is displaced.
const VOLUME_SLACK: f64 = 1e-6;

/// The same where drops leave, and of the momentum they take.
const DROPS_SLACK: f64 = 1e-5;

/// No value may be above this: what the crate says it never keeps, and its rounding.
const CAP: f64 = 1e4 * (1.0 + 1e-6);

/// Below this height in m the surface rests.
const REST_M: f64 = 1e-7;

/// Rounding of a height in a step, as a part of it.
const ROUNDING: f64 = 4e-7;

/// What acts in a step, and how much energy it may give.
pub struct Work {
    before_j: f64,
    before_m: Vec<f32>,
    pushes: Vec<Push>,
    /// Force on each node.
    force_n: Vec<f64>,
    kicks_j: f64,
}

/// A touch: nodes under it with their shares, its force, and whether it damps.
struct Push {
    under: Vec<(usize, f32)>,
    force_n: f64,
    damps: bool,
}

impl Work {
    /// Nothing yet.
    pub fn before(surface: &Surface) -> Self {
        Self {
            before_j: surface.energy_j(),
            before_m: surface.height_m().to_vec(),
            pushes: Vec::new(),
            force_n: Vec::new(),
            kicks_j: 0.0,
        }
    }

    /// Enters a touch.
    pub fn of_touch(
        &mut self,
        surface: &Surface,
        at: Vec3,
        radius_m: f32,
        force_n: f32,
        damping: f32,
    ) {
        let mut under = Vec::new();
        surface.lattice().find_under(at, radius_m, &mut under);
        self.pushes.push(Push { under, force_n: force_n.into(), damps: damping > 0.0 });
    }

    /// Enters a kick.
    pub fn of_kick(&mut self, energy_j: f32) {
        self.kicks_j += f64::from(energy_j.abs());
    }

    /// Enters a pressure.
    pub fn of_pressure(&mut self, surface: &Surface, pressure_pa: impl Fn(Vec3) -> f32) {
        let lattice = surface.lattice();
        let force_n = |n| f64::from(lattice.node_m2() * pressure_pa(lattice.in_world_m(n)));
        let held = |n: usize| if lattice.wet[n] { force_n(n) } else { 0.0 };
        self.force_n = (0..lattice.len()).map(held).collect();
    }

    /// Compares the energy after the step with what forces gave; and the volume with none.
    pub fn after(self, case: &Case, surface: &Surface, ledger: &mut Ledger, step: usize) {
        let moved = |n: usize| f64::from(surface.height_m()[n]) - f64::from(self.before_m[n]);
        let size = |n: usize| f64::from(surface.height_m()[n].abs().max(self.before_m[n].abs()));
        let mut given_j = self.kicks_j;
        let mut rounding_j = 0.0;
        for Push { under, force_n, damps } in &self.pushes {
            let sum = |value: &dyn Fn(usize) -> f64| -> f64 {
                under.iter().map(|(n, share)| f64::from(*share) * value(*n)).sum()
            };
            let work_j = force_n * sum(&moved);
            // How much of the force a damper leaves, it alone knows.
            given_j += if *damps { work_j.max(0.0) } else { work_j };
            rounding_j += force_n.abs() * sum(&size);
        }
        for (n, force_n) in self.force_n.iter().enumerate() {
            given_j += force_n * moved(n);
            rounding_j += force_n.abs() * size(n);
        }
        let after_j = surface.energy_j();
        let allowed_j = self.before_j + given_j + ROUNDING * rounding_j;
        let all_j = self.before_j.max(after_j) + given_j.abs();
        // What falls asleep gives away what it had.
        let gained = after_j > allowed_j && !surface.is_asleep();
        let excess = if gained { (after_j - allowed_j) / all_j } else { 0.0 };
        let excess = if after_j.is_finite() { excess } else { f64::NAN };
        ledger.check("energy_excess", excess, ENERGY_SLACK, step);
        if !case.splashes {
            let sum = |value: fn(f64) -> f64| -> f64 {
                surface.height_m().iter().map(|y| value(f64::from(*y))).sum()
            };
            let displaced_m = sum(f64::abs) + REST_M * surface.lattice().wet_count() as f64;
            ledger.check("volume_error", sum(|y| y).abs() / displaced_m, VOLUME_SLACK, step);
        }
    }
}

/// Looks at every value there is, and at what is told of a place.
pub fn look(surface: &Surface, at: Vec3, ledger: &mut Ledger, step: usize) {
    let (height_m, speed_m_s) = surface.at(at);
    let (then_m, then_m_s) = surface.ahead(at);
    let told = [height_m, speed_m_s, then_m, then_m_s, surface.orbit_m_s(at).length()];
    ledger.check("told_strange", told.iter().filter(|v| !v.is_finite()).count() as f64, 0.0, step);
    let nodes = surface.height_m().iter().chain(surface.speed_m_s());
    let largest =
        nodes.fold(0.0_f32, |most, v| if v.abs() > most || v.is_nan() { v.abs() } else { most });
    ledger.check("largest", largest.into(), CAP, step);
    let beside = surface.lattice().wet.iter().zip(surface.height_m());
    let moved = beside.filter(|(wet, height_m)| !**wet && **height_m != 0.0).count();
    ledger.check("dry_moved", moved as f64, 0.0, step);
}

/// Rounding of a drop's velocity and place in a step, and of the energy of a flow, as a part.
const FLIGHT_ROUNDING: f64 = 1e-6;

/// A sheet's largest stiffness by area is this times tension over the square of the spacing, and
/// what gravity gives: more than 8 (5/6 + bend) of springs, and 2 pi^2 of waves.
const STIFFEST: f64 = 20.0;

/// What there was before drops did anything.
pub struct Before {
    energy_j: f64,
    /// What f32 may have changed it by.
    rounding_j: f64,
    spilled_j: f64,
    lent_j: f64,
}

impl Liquid {
    /// To compare with.
    pub fn before(&self, case: &Case, surface: &Surface) -> Before {
        let SplashBooks { spilled_j, lent_j, .. } = *self.splash.books();
        let energy_j = self.energy_j(case, surface);
        let [density, gravity, dt_s] =
            [case.density_kg_m3, case.gravity_m_s2, case.dt_s].map(f64::from);
        let rest_m = f64::from(surface.rest_height_in_world_m().abs());
        let drops = self.splash.drops().iter().map(|drop| {
            let [speed, y] =
                [drop.velocity_m_s.length(), drop.at_in_world_m.y.abs()].map(f64::from);
            let speed = speed + gravity * dt_s;
            density * drop.volume_m3 * (speed * speed + gravity * (rest_m + y + dt_s * speed))
        });
        // Of a sheet it is a form of heights, so that of h + e is at most (sqrt E + sqrt E(e))^2.
        let [spacing_m, tension, bend] =
            [case.spacing_m(), case.params.tension_n_per_m.into(), case.params.bend.into()];
        let stiffest_n_per_m =
            density * gravity * spacing_m * spacing_m + STIFFEST * tension * (1.0 + bend);
        let squares_m2: f64 = surface.height_m().iter().map(|y| f64::from(*y).powi(2)).sum();
        let of_heights_j = 0.5 * stiffest_n_per_m * ROUNDING * ROUNDING * squares_m2;
        let of_sheet_j = 2.0 * (energy_j.abs() * of_heights_j).sqrt() + of_heights_j;
        let size_j = energy_j.abs() + drops.sum::<f64>();
        Before { energy_j, rounding_j: FLIGHT_ROUNDING * size_j + of_sheet_j, spilled_j, lent_j }
    }

    /// Energy of the surface, of the liquid below, of drops, and of the level.
    fn energy_j(&self, case: &Case, surface: &Surface) -> f64 {
        let [density, gravity] = [case.density_kg_m3, case.gravity_m_s2].map(f64::from);
        let drops = self.splash.drops().iter().map(|drop| self.splash.energy_j(surface, drop));
        let lattice = surface.lattice();
        let wet_m2 = f64::from(lattice.node_m2()) * lattice.wet_count() as f64;
        let level_j = 0.5 * density * gravity * wet_m2 * f64::from(surface.level_m()).powi(2);
        surface.energy_j() + self.flow.kinetic_energy_j() + drops.sum::<f64>() + level_j
    }

    /// Compares energy, volume and momentum around what drops did.
    pub fn ask(
        &self,
        case: &Case,
        surface: &Surface,
        before: &Before,
        ledger: &mut Ledger,
        step: usize,
    ) {
        let (after_j, books) = (self.energy_j(case, surface), self.splash.books());
        if books.drops > 0 {
            let lent_j = books.lent_j - before.lent_j;
            let gained_j = after_j + books.spilled_j - before.spilled_j - before.energy_j;
            let part = |energy_j: f64| {
                energy_j / (before.energy_j.abs() + before.rounding_j).max(f64::MIN_POSITIVE)
            };
            let excess = part((gained_j - lent_j - before.rounding_j).max(0.0));
            ledger.check("splash_excess", excess, 0.0, step);
            // Only what is set from outside rises over drops.
            let most = if case.jump_m > 0.0 { f64::MAX } else { part(before.rounding_j) };
            ledger.check("splash_lent", part(lent_j), most, step);
        }
        let all_m3 = surface.volume_m3() + self.splash.airborne_m3() + books.spilled_m3;
        let lattice = surface.lattice();
        let heights = surface.height_m().iter().map(|y| f64::from(y.abs()) + REST_M);
        let displaced_m3 = heights.sum::<f64>() * f64::from(lattice.node_m2()) + books.left_m3;
        ledger.check("volume_error", all_m3.abs() / displaced_m3, DROPS_SLACK, step);
        ledger.check("momentum_error", books.residual_rel(), DROPS_SLACK, step);
        ledger.most("drops", books.drops as f64);
    }
}
