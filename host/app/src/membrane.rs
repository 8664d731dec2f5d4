//! What spring or neck of the surface held when it broke: the hand does not get it back, so it
//! leaves as a wave.
//!
//! The device renders F = k (y - tau v) with its own k = felt_scale scale k_physical, and for a
//! probe that floats damps its buoyancy's stiffness K alike; S = F + (k + K) tau v is the spring's
//! part of that and the rest went to heat. The spring held S^2 / (2 k) felt
//! joules; a felt joule is a felt newton over a device metre, which is scale / felt_scale
//! physical ones:
//!
//! ```text
//! E = S^2 / (2 k) scale / felt_scale = (S / felt_scale)^2 / (2 k_physical)
//! ```

use cauldron_firmware::{TICK_S, servo::DAMPING_S};
use cauldron_fluid::{force::Floating, scenes::Scene};
use cauldron_protocol::{Limit, State, state::Flags};

/// Watches the device's states for the moments in which spring or neck break.
#[derive(Clone, Debug)]
pub struct Membrane {
    /// Of the device: felt newtons for a device metre.
    stiffness_n_per_m: f64,
    /// Of the dampers at the surface, likewise.
    damping_n_s_per_m: f64,
    /// Physical joules of a felt one.
    physical: f64,
    last: Option<State>,
    /// The spring's part of the force in the last tick that touched.
    spring_n: f64,
}

impl Membrane {
    /// For the surface of a scene, if it has one.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let felt_scale = f64::from(scene.feel.felt_scale);
        let scale = f64::from(scene.feel.world_from_device.scale);
        let stiffness = scene.surface.map_or(0.0, |s| f64::from(s.contact_stiffness_n_per_m));
        let buoyant = Floating::of(scene).map_or(0.0, |floating| floating.stiffness_n_per_m());
        let damped = felt_scale * scale * (stiffness + buoyant);
        Self {
            stiffness_n_per_m: felt_scale * scale * stiffness,
            damping_n_s_per_m: f64::from(DAMPING_S) * damped,
            physical: scale / felt_scale,
            last: None,
            spring_n: 0.0,
        }
    }

    /// The energy in physical joules that the surface let go of between the state before and this
    /// one; below zero if it was drawn up, and falls back. A surface that went stale held nothing
    /// any more.
    pub fn note(&mut self, state: &State) -> Option<f64> {
        let before = self.last.replace(*state)?;
        let was = |flag| before.flags.contains(flag);
        let is = |flag| state.flags.contains(flag);
        if is(Flags::ON_SURFACE) || is(Flags::CLINGING) {
            if state.tick.since(before.tick) == 1 {
                self.spring_n = self.spring_part_n(&before, state);
            }
            return None;
        }
        let popped = was(Flags::ON_SURFACE) && is(Flags::WET);
        let let_go = was(Flags::CLINGING) && !is(Flags::WET);
        let felt_j = self.spring_n * self.spring_n / (2.0 * self.stiffness_n_per_m);
        self.spring_n = 0.0;
        let held = self.stiffness_n_per_m > 0.0 && felt_j > 0.0;
        let broke = (popped || let_go) && !state.limits.contains(Limit::Staleness);
        let way = if popped { 1.0 } else { -1.0 };
        (broke && held).then_some(way * self.physical * felt_j)
    }

    /// S of the tick between two states, from the impulse that the medium got: walls, weight and
    /// buoyancy are not in it.
    fn spring_part_n(&self, before: &State, state: &State) -> f64 {
        let [_, now, _] = state.impulse_to_fluid;
        let [_, then, _] = before.impulse_to_fluid;
        let force_n = -1e-12 * now.0.wrapping_sub(then.0) as f64 / f64::from(TICK_S);
        let [_, rising, _] = state.velocity;
        force_n + self.damping_n_s_per_m * f64::from(rising.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_fluid::scenes;
    use cauldron_protocol::units::{MetresPerSecond, PiconewtonSeconds, Ticks};

    /// States in which the medium pushes the hand by `force_n` with a flag, at a rising speed.
    fn states(ticks: &[(Flags, f64, f32)]) -> Vec<State> {
        let mut sum = 0;
        let state = |(tick, (flags, force_n, rising)): (usize, &(Flags, f64, f32))| {
            sum -= (force_n * 1e9) as i64;
            State {
                tick: Ticks(tick as u32),
                impulse_to_fluid: [0, sum, 0].map(PiconewtonSeconds),
                velocity: [0.0, *rising, 0.0].map(MetresPerSecond),
                flags: *flags,
                ..State::default()
            }
        };
        ticks.iter().enumerate().map(state).collect()
    }

    fn released_j(ticks: &[(Flags, f64, f32)]) -> f64 {
        let mut membrane = Membrane::new(&(scenes::INDEX[0].make)());
        states(ticks).iter().filter_map(|s| membrane.note(s)).sum()
    }

    const AIR: Flags = Flags::DEADMAN;

    #[test]
    fn what_breaks_lets_go_of_its_energy_in_physical_joules() {
        // 0.12 N on 32 N/m: 0.225 mJ; felt sixfold.
        let physical_j = 0.12 * 0.12 / 64.0;
        let pop = [(AIR, 0.0, 0.0), (Flags::ON_SURFACE, 0.72, 0.0), (Flags::WET, 0.0, 0.0)];
        assert!((released_j(&pop) / physical_j - 1.0).abs() < 1e-6, "{}", released_j(&pop));
        let off = [(Flags::WET, 0.0, 0.0), (Flags::CLINGING, -0.72, 0.0), (AIR, 0.0, 0.0)];
        assert!((released_j(&off) / physical_j + 1.0).abs() < 1e-6, "{}", released_j(&off));
    }

    #[test]
    fn what_the_damper_took_is_heat() {
        let damped = 32.0 * 6.0 * 1.2 * 0.01 * 0.1; // of 0.1 m/s
        let fast = [(AIR, 0.0, 0.0), (Flags::ON_SURFACE, 0.72, -0.1), (Flags::WET, 0.0, -0.1)];
        let spring_n = (0.72 - damped) / 6.0;
        assert!((released_j(&fast) / (spring_n * spring_n / 64.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_taken_back_is_not_released() {
        for end in [AIR, Flags::ON_SURFACE] {
            let left = [(AIR, 0.0, 0.0), (Flags::ON_SURFACE, 0.5, 0.0), (end, 0.0, 0.0)];
            assert_eq!(released_j(&left), 0.0);
        }
        let back = [(Flags::WET, 0.0, 0.0), (Flags::CLINGING, -0.3, 0.0), (Flags::WET, 0.0, 0.0)];
        assert_eq!(released_j(&back), 0.0);
    }
}
