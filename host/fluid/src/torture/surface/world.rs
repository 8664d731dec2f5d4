//! The surface of a case, what is below it, and all that is done to it.

use std::sync::Arc;

use glam::Vec3;
use oorandom::Rand64;

use super::{
    asked::{Work, look},
    case::Case,
};
use crate::{
    pool::Pool,
    simd::SimdClass,
    solver::{Setup, Solver, flow::Flow},
    splash::{Below, Splash},
    substance::{Properties, Substances},
    surface::{Basin, Surface},
    torture::{
        draw::{chance, log_uniform},
        ledger::Ledger,
    },
};

/// Magnitudes from this part of the largest up are drawn.
const LEAST: f64 = 1e-4;

/// Steps between jumps.
const JUMPS_EVERY: usize = 40;

/// Steps between looks below, each of which takes as long as many steps of large surfaces.
const LOOKS_BELOW_EVERY: usize = 8;

/// What drops leave and fall into.
pub struct Liquid {
    /// The liquid.
    pub flow: Flow,
    /// What is in it.
    pub substances: Substances,
    /// The drops.
    pub splash: Splash,
}

/// A case that runs.
pub struct World<'a> {
    /// What is done.
    pub case: &'a Case,
    /// What is tortured.
    pub surface: Surface,
    /// The liquid, if drops leave.
    pub below: Option<Liquid>,
    draws: Rand64,
}

impl<'a> World<'a> {
    /// The surface of a case, at rest. The error says why there can be none.
    pub fn new(case: &'a Case, pool: &Arc<Pool>, simd: SimdClass) -> Result<Self, String> {
        let Case { density_kg_m3, viscosity_m2_s, gravity_m_s2, .. } = *case;
        let (grid, vessel) = (&case.grid, &case.vessel);
        let basin = Basin { grid, vessel, density_kg_m3, viscosity_m2_s, gravity_m_s2, simd };
        let surface = Surface::new(case.params, &basin).map_err(|refused| refused.to_string())?;
        let below = if case.splashes { Some(Liquid::new(case, pool, simd)?) } else { None };
        let draws = Rand64::new(u128::from(case.seed) | (1 << 100));
        Ok(Self { case, surface, below, draws })
    }

    /// One step, and all that is done to the surface before it.
    pub fn mistreat(&mut self, ledger: &mut Ledger, step: usize) {
        if step.is_multiple_of(JUMPS_EVERY) && self.case.jump_m > 0.0 {
            self.jump();
        }
        let mut work = Work::before(&self.surface);
        for _ in 0..self.draws.rand_range(0..3) {
            self.poke(&mut work);
        }
        if self.case.kick_j > 0.0 && chance(&mut self.draws, 0.2) {
            self.kick(&mut work);
        }
        if self.case.press_pa > 0.0 && chance(&mut self.draws, 0.5) {
            self.press(&mut work);
        }
        let at = self.place();
        self.surface.look_ahead(self.case.dt_s);
        if step.is_multiple_of(LOOKS_BELOW_EVERY) {
            self.surface.look_below(at);
        }
        let report = self.surface.step(self.case.dt_s);
        ledger.count("guard_actions", f64::from(report.guard_actions));
        ledger.most("substeps", f64::from(report.substeps));
        if report.guard_actions == 0 {
            work.after(self.case, &self.surface, ledger, step);
        }
        look(&self.surface, at, ledger, step);
        if let Some(below) = &mut self.below {
            below.step(self.case, &mut self.surface, ledger, step);
        }
    }

    /// Offers what is not finite in one of its numbers, or what no step can last: it is to be left
    /// out, whatever it is. And looks where and when there is nothing to be seen.
    pub fn offer_bad(&mut self) {
        let at = self.surface.lattice().in_world_m(0);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            self.surface.touch(at.with_x(bad), 0.01, 1.0, 1.0);
            self.surface.touch(at, bad, 1.0, 1.0);
            self.surface.touch(at, 0.01, bad, 1.0);
            self.surface.touch(at, 0.01, 1.0, bad);
            self.surface.kick(at.with_z(bad), 0.01, 1.0);
            self.surface.kick(at, bad, 1.0);
            self.surface.kick(at, 0.01, bad);
            self.surface.press(|_| bad);
            self.surface.look_ahead(bad);
            self.surface.look_below(at.with_y(bad));
            self.surface.step(bad);
        }
        for bad_s in [0.0, -0.0, -self.case.dt_s] {
            self.surface.step(bad_s);
            self.surface.look_ahead(bad_s);
        }
        for far_s in [f32::MIN_POSITIVE, 1e-9, 1e3, f32::MAX] {
            self.surface.look_ahead(far_s);
        }
        for far_m in [1e3, f32::MAX] {
            self.surface.look_below(at.with_y(-far_m));
            self.surface.look_below(at.with_y(far_m));
        }
    }

    /// Somewhere over the box, or a little beside it.
    fn place(&mut self) -> Vec3 {
        let mut share = || 1.1 * self.draws.rand_float() as f32 - 0.05;
        Vec3::new(share(), share(), share()) * self.case.grid.extent_m()
    }

    /// A radius of less than a node to a third of the edge.
    fn radius_m(&mut self) -> f32 {
        let widest = f64::from(self.case.grid.extent_m().max_element()) / 3.0;
        log_uniform(&mut self.draws, [0.1 * self.case.spacing_m(), widest]) as f32
    }

    /// A number up to `most` of either sign, small ones as often as large ones.
    fn up_to(&mut self, most: f64) -> f64 {
        let sign = if chance(&mut self.draws, 0.5) { 1.0 } else { -1.0 };
        sign * most * log_uniform(&mut self.draws, [LEAST, 1.0])
    }

    fn poke(&mut self, work: &mut Work) {
        let (at, radius_m) = (self.place(), self.radius_m());
        let force_n = self.up_to(self.case.poke_n) as f32;
        let damping = self.up_to(self.case.damping_n_s_per_m).abs() as f32;
        self.surface.touch(at, radius_m, force_n, damping);
        work.of_touch(&self.surface, at, radius_m, force_n, damping);
    }

    fn kick(&mut self, work: &mut Work) {
        let (at, radius_m) = (self.place(), self.radius_m());
        let energy_j = self.up_to(self.case.kick_j) as f32;
        self.surface.kick(at, radius_m, energy_j);
        work.of_kick(energy_j);
    }

    fn press(&mut self, work: &mut Work) {
        let extent_m = self.case.grid.extent_m();
        let [a, b] = [(); 2].map(|()| self.up_to(self.case.press_pa) as f32);
        let pressure_pa =
            move |at: Vec3| a * (9.0 * at.x / extent_m.x).sin() + b * at.z / extent_m.z;
        self.surface.press(pressure_pa);
        work.of_pressure(&self.surface, pressure_pa);
    }

    /// One side of a line is suddenly higher, and rises; and a node is told no numbers.
    fn jump(&mut self) {
        let (at, height_m) = (self.place(), self.up_to(self.case.jump_m) as f32);
        let speed_m_s = self.up_to(self.case.jump_m) as f32;
        let first = self.surface.lattice().in_world_m(0);
        let or_bad = |x, z, value, bad| if [x, z] == [first.x, first.z] { bad } else { value };
        self.surface.set(
            |x, z| or_bad(x, z, if x < at.x { height_m } else { 0.0 }, f32::NAN),
            |x, z| or_bad(x, z, if z < at.z { speed_m_s } else { 0.0 }, f32::INFINITY),
        );
    }

    /// All that is stored, as one number that any changed bit changes.
    pub fn fingerprint(&self) -> u64 {
        // FNV-1a (Fowler, Noll, Vo), by values instead of bytes.
        let mix = |hash: u64, bits: u64| (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
        let nodes = self.surface.height_m().iter().chain(self.surface.speed_m_s());
        let hash = nodes.fold(0xcbf2_9ce4_8422_2325, |hash, v| mix(hash, v.to_bits().into()));
        let mut hash = mix(hash, self.surface.volume_m3().to_bits());
        if let Some(below) = &self.below {
            below.flow.visit(&mut |_, _, value| hash = mix(hash, value.to_bits()));
            hash = mix(hash, below.splash.books().drops);
        }
        hash
    }
}

impl Liquid {
    fn new(case: &Case, pool: &Arc<Pool>, simd: SimdClass) -> Result<Self, String> {
        let setup = Setup {
            density_kg_m3: case.density_kg_m3,
            viscosity_m2_s: case.viscosity_m2_s,
            pool: Arc::clone(pool),
            simd,
            ..Setup::new(case.grid, case.vessel.clone())
        };
        let mut substances = Substances::new(&setup, &[Properties::of_liquid(&setup)]);
        let flow = Flow::new(&setup).map_err(|refused| refused.to_string())?;
        let half_m = 0.5 * case.grid.extent_m().x;
        substances
            .set_fraction(0, |at| if at.x < half_m { 0.8 } else { 0.0 })
            .map_err(|refused| refused.to_string())?;
        Ok(Self { flow, substances, splash: Splash::new(case.density_kg_m3, case.gravity_m_s2) })
    }

    /// The liquid moves on, drops fly, and what they did is asked for.
    fn step(&mut self, case: &Case, surface: &mut Surface, ledger: &mut Ledger, step: usize) {
        let moved = self.flow.step(case.dt_s.into()).map(drop);
        let carried = moved.and_then(|()| self.substances.step(&self.flow, case.dt_s.into()));
        if let Err(refused) = carried {
            let told = format!("in step {step}, {refused}");
            ledger.failures.entry("finite input").or_insert(told);
        }
        let before = self.before(case, surface);
        let Self { flow, substances, splash } = self;
        splash.step(Below { surface, flow, substances }, case.dt_s);
        self.ask(case, surface, &before, ledger, step);
    }
}
