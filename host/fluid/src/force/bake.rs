//! Bakes the field that travels to the device: a window of nodes around the probe, in device
//! metres and felt newtons, predicted to the end of its life.
//!
//! A length in the world is `scale` times one of the device, and a felt force is `felt_scale`
//! times a physical one, so of F = (c1 + c2 |w|) w the device is sent
//! u / scale, felt_scale scale c1, and felt_scale scale^2 c2.
//!
//! Weight and buoyancy of a probe that has them are its bias: felt_scale times their force on a
//! sphere centred at the node, at the local height of the surface. Between the nodes, h apart, it
//! is interpolated, which errs by at most rho g pi a h^2 / 4 for a sphere larger than that.
//!
//! The loop through the hand closes only after the field has travelled: a drag that could stop
//! the liquid it moves within that time would overshoot and swing. So the drag that is sent is
//! at most the moved mass over the loop's time, whatever the liquid (with c dt/m above 1: honey),
//! and at most what the device's own loop can hold, whose velocity is some 12 ms late.

use cauldron_protocol::{
    WorldFromDevice,
    field::{Channel, FieldHead, MAX_PATCH_NODES, PatchChannel, PatchHead, quantum_for},
    message::{Buoyancy, Keep, RestMedium},
    units::{Metres, NewtonSeconds2PerMetre2, NewtonSecondsPerMetre, NewtonsPerMetre, Ticks},
};
use glam::Vec3;

use super::{Floating, drag::Drag};
use crate::pot::Pot;

/// Nodes of the window along an axis, and of the surface patch.
const NODES: usize = 8;

const _: () = assert!(NODES * NODES <= MAX_PATCH_NODES, "the patch must fit");

/// The time a field lives in, in device ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Life {
    /// When it is expected to arrive, and the ramp to it begins.
    pub from: Ticks,
    /// When the next one is expected, the moment it predicts.
    pub until: Ticks,
    /// From the state of the fluid to that moment.
    pub ahead_s: f32,
}

/// A field as it is sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Its head.
    pub head: FieldHead,
    /// Its samples, in the order of the protocol.
    pub samples: Vec<i16>,
}

/// What to send.
#[derive(Clone, Debug, PartialEq)]
pub enum Update {
    /// A new field.
    Field(Baked),
    /// Nothing changed by a quantum.
    Keep(Keep),
}

/// Drag at the hand that the device's own loop holds with ease: a hand and a handle of 0.1 kg,
/// over twice the lag of its velocity.
const MOST_FELT_N_S_PER_M: f64 = 10.0;

/// Values of a channel at the window's nodes.
type Nodes = Vec<f32>;

/// Bakes field after field of one pot.
#[derive(Clone, Debug)]
pub struct Baker {
    world_from_device: WorldFromDevice,
    felt_scale: f32,
    drag: Drag,
    /// From exchange to exchange with what the probe gave, the field's way included.
    loop_s: f64,
    spacing_m: f32,
    corner: [i32; 3],
    flow_before: [Nodes; 3],
    epoch: u32,
    sent: Option<Baked>,
}

impl Baker {
    /// For the probe and liquid of `pot`, felt through a map and a scale, with `loop_s` from a
    /// force to the field that knows of it.
    #[must_use]
    pub fn new(
        pot: &Pot,
        world_from_device: WorldFromDevice,
        felt_scale: f32,
        loop_s: f64,
    ) -> Self {
        Self {
            world_from_device,
            felt_scale,
            drag: pot.drag(),
            loop_s,
            spacing_m: pot.grid().spacing_m,
            corner: [i32::MIN; 3],
            flow_before: [const { Vec::new() }; 3],
            epoch: 0,
            sent: None,
        }
    }

    /// Fields baked so far, kept ones not counted.
    #[must_use]
    pub fn epoch(&self) -> u32 {
        self.epoch
    }

    /// Moves the window to where the probe is expected (in world metres), and notes the flow
    /// there; to be called before the pot's step.
    pub fn aim(&mut self, pot: &Pot, expected_in_world_m: Vec3) {
        let cell = (expected_in_world_m - pot.grid().origin_in_world_m) / self.spacing_m;
        // The window stays where it is while the probe is in its middle: a window that moves
        // with every step could never be kept.
        let middle = (NODES / 2) as i32;
        for (corner, x) in self.corner.iter_mut().zip(cell.to_array()) {
            let cell = x.floor().clamp(-1e6, 1e6) as i32;
            if (i64::from(cell) - i64::from(*corner) - i64::from(middle)).abs() > 1 {
                *corner = cell - middle + 1;
            }
        }
        self.flow_before = self.flow(pot);
    }

    /// The field of the pot after its step of `dt_s`, or a Keep if it would not differ from the
    /// one sent last.
    pub fn bake(&mut self, pot: &Pot, dt_s: f32, life: Life) -> Update {
        let mut baked = self.window(pot, dt_s, life);
        if let Some(sent) = &mut self.sent {
            baked.head.epoch = sent.head.epoch;
            if baked.samples == sent.samples && is_same_place(&baked.head, &sent.head) {
                return Update::Keep(Keep { epoch: sent.head.epoch, valid_until: life.until });
            }
        }
        self.epoch += 1;
        baked.head.epoch = self.epoch;
        self.sent = Some(baked.clone());
        Update::Field(baked)
    }

    /// The medium at rest as the device feels it, for where no field reaches.
    #[must_use]
    pub fn rest_medium(&self, pot: &Pot) -> RestMedium {
        let (linear, quadratic) = self.felt_drag(pot);
        RestMedium {
            linear_drag: NewtonSecondsPerMetre(linear),
            quadratic_drag: NewtonSeconds2PerMetre2(quadratic),
        }
    }

    /// Felt force at which the surface lets go of a probe; 0 without a surface. It is the scene's,
    /// so it does not travel with every field.
    #[must_use]
    pub fn pull_force_n(&self, pot: &Pot) -> f32 {
        pot.surface().map_or(0.0, |surface| self.felt_scale * surface.params().pull_force_n)
    }

    /// How stiffly the probe floats, at the hand; nothing for one without weight.
    #[must_use]
    pub fn buoyancy(&self, pot: &Pot) -> Buoyancy {
        let scale = self.world_from_device.scale;
        pot.floating().map_or(Buoyancy::default(), |floating| Buoyancy {
            radius: Metres(pot.probe_radius_m() / scale),
            stiffness: NewtonsPerMetre(
                self.felt_scale * scale * floating.stiffness_n_per_m() as f32,
            ),
        })
    }

    /// Forgets what was sent: the device forgot it too.
    pub fn restart(&mut self) {
        self.sent = None;
    }

    /// Place of a node in world metres.
    fn node(&self, pot: &Pot, [i, j, k]: [usize; 3]) -> Vec3 {
        let [a, b, c] = self.corner;
        let step = Vec3::new((a + i as i32) as f32, (b + j as i32) as f32, (c + k as i32) as f32);
        pot.grid().origin_in_world_m + self.spacing_m * step
    }

    /// Velocity of the liquid in world m/s at the window's nodes, its waves with it; nothing for a
    /// scene without liquid.
    fn flow(&self, pot: &Pot) -> [Nodes; 3] {
        let mut nodes = [const { Vec::new() }; 3];
        let Some(flow) = pot.flow() else { return nodes };
        for n in 0..NODES * NODES * NODES {
            let at = self.node(pot, [n % NODES, n / NODES % NODES, n / (NODES * NODES)]);
            let waves = pot.surface().map_or(Vec3::ZERO, |surface| surface.orbit_m_s(at));
            let velocity = flow.velocity_linear_at(at) + waves;
            nodes.iter_mut().zip(velocity.to_array()).for_each(|(nodes, u)| nodes.push(u));
        }
        nodes
    }

    fn window(&self, pot: &Pot, dt_s: f32, life: Life) -> Baked {
        let scale = self.world_from_device.scale;
        let origin = self.world_from_device.point_in_device(self.node(pot, [0; 3]).to_array());
        let mut head = FieldHead {
            valid_from: life.from,
            valid_until: life.until,
            nodes: [NODES as u8; 3],
            origin: origin.map(Metres),
            spacing: Metres(self.spacing_m / scale),
            ..FieldHead::default()
        };
        let mut samples = Vec::new();
        if pot.flow().is_some() {
            head.channels = Channel::FLOW.and(Channel::DRAG);
            let values = self.medium(pot, dt_s, life.ahead_s);
            for (quantum, nodes) in head.quanta.iter_mut().zip(&values) {
                *quantum = quantise(nodes, &mut samples);
            }
        }
        if let Some(floating) = pot.floating() {
            head.channels = head.channels.and(Channel::BIAS_Y);
            let bias = self.bias(pot, floating);
            head.quanta[Channel::BiasY as usize] = quantise(&bias, &mut samples);
        }
        if pot.surface().is_some() {
            head.patch = Some(self.patch(pot, origin, &mut samples));
        }
        Baked { head, samples }
    }

    /// The channels of flow and drag, in device units: the flow with its change of the last
    /// step carried on to the moment that the field predicts.
    fn medium(&self, pot: &Pot, dt_s: f32, ahead_s: f32) -> [Nodes; 5] {
        let scale = self.world_from_device.scale;
        let now = self.flow(pot);
        let carry = if dt_s > 0.0 { ahead_s / dt_s } else { 0.0 };
        let mut values = [const { Vec::new() }; 5];
        for ((to, now), before) in values.iter_mut().zip(&now).zip(&self.flow_before) {
            to.extend(now.iter().zip(before).map(|(u, before)| (u + carry * (u - before)) / scale));
        }
        let (linear, quadratic) = self.felt_drag(pot);
        values[3] = vec![linear; NODES * NODES * NODES];
        values[4] = vec![quadratic; NODES * NODES * NODES];
        values
    }

    /// The vertical bias, in felt newtons. A liquid without a surface is everywhere.
    fn bias(&self, pot: &Pot, floating: Floating) -> Nodes {
        let everywhere = if pot.flow().is_some() { f64::INFINITY } else { f64::NEG_INFINITY };
        let depth_m = |at: Vec3| {
            let level = surface_y_in_world_m(pot, at);
            level.map_or(everywhere, |y_m| f64::from(y_m - at.y))
        };
        (0..NODES * NODES * NODES)
            .map(|n| self.node(pot, [n % NODES, n / NODES % NODES, n / (NODES * NODES)]))
            .map(|at| self.felt_scale * floating.force_n(depth_m(at)) as f32)
            .collect()
    }

    /// c1 and c2 in device units.
    fn felt_drag(&self, pot: &Pot) -> (f32, f32) {
        let (scale, drag) = (self.world_from_device.scale, self.bounded_drag(pot));
        let linear = self.felt_scale * scale * drag.linear_n_s_per_m as f32;
        (linear, self.felt_scale * scale * scale * drag.quadratic_n_s2_per_m2 as f32)
    }

    /// The drag, held below what the loop can follow.
    fn bounded_drag(&self, pot: &Pot) -> Drag {
        let Some(mass_kg) = pot.moved_mass_kg() else { return self.drag };
        let felt = f64::from(self.felt_scale * self.world_from_device.scale);
        let most_n_s_per_m = (mass_kg / self.loop_s).min(MOST_FELT_N_S_PER_M / felt);
        let brisk = self.drag.force_n(Drag::FITTED_TO_M_S) / Drag::FITTED_TO_M_S;
        self.drag.scaled((most_n_s_per_m / brisk).min(1.0))
    }

    fn patch(&self, pot: &Pot, [x, _, z]: [f32; 3], samples: &mut Vec<i16>) -> PatchHead {
        let scale = self.world_from_device.scale;
        let mut values: [Nodes; PatchChannel::COUNT] = [const { Vec::new() }; _];
        for n in 0..NODES * NODES {
            let at = self.node(pot, [n % NODES, 0, n / NODES]);
            let node = pot.surface().map_or([0.0; 4], |surface| {
                let params = surface.params();
                let (_, speed_m_s) = surface.ahead(at);
                let y_m = surface_y_in_world_m(pot, at).unwrap_or(0.0);
                let height = self.world_from_device.point_in_device([0.0, y_m, 0.0])[1];
                [
                    height,
                    speed_m_s / scale,
                    self.felt_scale * scale * params.contact_stiffness_n_per_m,
                    self.felt_scale * params.break_force_n,
                ]
            });
            values.iter_mut().zip(node).for_each(|(to, value)| to.push(value));
        }
        PatchHead {
            nodes: [NODES as u8; 2],
            origin: [Metres(x), Metres(z)],
            spacing: Metres(self.spacing_m / scale),
            quanta: values.each_ref().map(|nodes| quantise(nodes, samples)),
        }
    }
}

/// Where the surface above or below a place will be when the field acts, if there is one.
fn surface_y_in_world_m(pot: &Pot, at: Vec3) -> Option<f32> {
    let surface = pot.surface()?;
    Some(surface.rest_height_in_world_m() + surface.ahead(at).0)
}

/// Appends a channel's samples; the value of a quantum.
fn quantise(nodes: &[f32], samples: &mut Vec<i16>) -> f32 {
    let largest = nodes.iter().fold(0.0, |most: f32, v| most.max(v.abs()));
    let quantum = quantum_for(largest);
    // A float to integer cast saturates, and takes NaN for zero.
    samples.extend(nodes.iter().map(|v| (v / quantum).round() as i16));
    quantum
}

/// True if two fields differ in nothing but samples and time.
fn is_same_place(a: &FieldHead, b: &FieldHead) -> bool {
    FieldHead { valid_from: b.valid_from, valid_until: b.valid_until, ..*a } == *b
}

#[cfg(test)]
mod tests;
