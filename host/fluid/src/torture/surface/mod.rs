//! Torture of the surface: seeds stand for sheets and waves that are poked, kicked, pressed and
//! thrown about as badly as can be.
//!
//! ```text
//! seed -> case -> world: touch, kick, press, set, step, splash ... then left alone -> verdict
//!                 asked: numbers, energy, volume, the same bits again
//! ```
//! Nothing but the public API is used. What is asked of each seed:
//! - every value is finite, and none above the crate's cap;
//! - energy is never above what it was plus the work of forces and the energy of kicks; dampers
//!   only take;
//! - drops bring no energy: that of surface, level, liquid, drops, and of what was spilled does not
//!   grow by what they do, but for rounding. Those that a jump buried are lent some, which is told:
//!   `splash_lent`, as a part of what there was;
//! - the volume stays: that of the pot, or with drops that of pot, air and floor together; so does
//!   the momentum that drops exchange with the liquid;
//! - a second run, on one thread, has the same bits, though only the first is offered touches,
//!   kicks and pressures that are not finite;
//! - what is damped and left alone comes to rest, or decays as it has to.

mod asked;
mod case;
mod corners;
mod rest;
mod world;

use std::sync::Arc;

pub use self::case::Case;
use self::{rest::Decay, world::World};
use super::{Group, Verdict, ledger::Ledger, params};
use crate::{pool::Pool, simd::SimdClass};

/// The surface.
pub const SURFACE: Group = Group {
    name: "surface",
    corners: corners::name,
    size: &["nodes_x", "nodes_z"],
    checks: &[
        ("energy_excess", "energy"),
        ("splash_excess", "splash"),
        ("splash_lent", "lent"),
        ("volume_error", "volume"),
        ("largest", "largest"),
        ("left_at_rest", "rest"),
        ("guard_actions", "guard"),
    ],
    run: |seed, pool, simd| run(&Case::of_seed(seed), pool, simd),
};

/// Tortures a surface with one case. Whatever happens ends up in the verdict: also a panic.
#[must_use]
pub fn run(case: &Case, pool: &Arc<Pool>, simd: SimdClass) -> Verdict {
    let mut verdict = Verdict::new(SURFACE.name, case.seed, (simd, pool.threads()));
    verdict.row.case = case.corner.unwrap_or("drawn").to_owned();
    verdict.row.method = case.params.model.to_owned();
    verdict.row.n = case.nodes().into_iter().max();
    verdict.row.params = params(case.figures());
    if Decay::of(case).is_none() {
        verdict.not_asked.push("rest: nothing damps it, or no one knows how fast");
    }
    verdict.judged(case.steps, || torture(case, pool, simd))
}

/// The error says why the model cannot do the case.
fn torture(case: &Case, pool: &Arc<Pool>, simd: SimdClass) -> Result<Ledger, String> {
    let mut ledger = Ledger::default();
    let mut world = World::new(case, pool, simd)?;
    let first = run_once(&mut world, &mut ledger, true);
    if let (Some(decay), true) = (Decay::of(case), ledger.failures.is_empty()) {
        decay.ask(&mut world, &mut ledger);
    }
    let mut again = World::new(case, &Arc::new(Pool::inline()), simd)?;
    let second = run_once(&mut again, &mut Ledger::default(), false);
    ledger.check("other_bits", f64::from(u8::from(first != second)), 0.0, case.steps);
    Ok(ledger)
}

/// Steps between two offers of what is not finite, each of which takes as long as some steps.
const BAD_EVERY: usize = 8;

/// All steps of a case. Returns a number that any changed bit changes.
fn run_once(world: &mut World<'_>, ledger: &mut Ledger, offers_bad: bool) -> u64 {
    for step in 0..world.case.steps {
        if offers_bad && step.is_multiple_of(BAD_EVERY) {
            world.offer_bad();
        }
        world.mistreat(ledger, step);
    }
    world.fingerprint()
}

#[cfg(test)]
mod tests;
