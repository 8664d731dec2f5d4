//! The medium around the probe: received slab by slab, ramped from one epoch to the next,
//! faded to rest when the host falls silent.
//!
//! The host sends what it predicts for `valid_until`, and the device ramps to it from
//! `valid_from`; of the ways to refresh a force at a low rate that one leaves the least ripple.

mod buffer;
mod shelf;
#[cfg(test)]
mod tests;
mod window;

pub use buffer::Buffer;
use shelf::Shelf;

use cauldron_protocol::{
    Refusal,
    field::{Channel, Channels, FieldHead, SlabHead},
    frame::count,
    message::{Keep, RestMedium},
    units::Ticks,
};

use crate::{
    math::{clamp, lerp},
    vector::Vec3,
};

/// A field is held this long past its end ...
const HELD_TICKS: i32 = 30;
/// ... and is faded to the medium at rest by then.
const FADED_TICKS: i32 = 60;
/// A medium that went stale comes back over this many ticks.
const RECOVERY_TICKS: f32 = 100.0;

/// A field may be promised for so long: one that never went stale would outlive its host.
const LONGEST_TICKS: i32 = 1000;

fn is_near(now: Ticks, until: Ticks) -> bool {
    until.since(now) <= LONGEST_TICKS
}

/// The medium at a point, in device metres and felt newtons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Medium {
    /// Velocity of the medium.
    pub flow_m_s: Vec3,
    /// c1 of F = (c1 + c2 |w|) w.
    pub linear_drag_n_s_per_m: f32,
    /// c2 of the same.
    pub quadratic_drag_n_s2_per_m2: f32,
    /// What no medium carries.
    pub bias_n: Vec3,
    /// The surface above or below the point, if there is one.
    pub surface: Option<Surface>,
}

/// The surface over a point of the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Height above the device's origin.
    pub height_m: f32,
    /// Its vertical velocity.
    pub velocity_m_s: f32,
    /// Force per depth under the probe.
    pub stiffness_n_per_m: f32,
    /// Force at which the probe goes through.
    pub break_force_n: f32,
}

impl Medium {
    fn from_channels(values: [f32; Channel::COUNT], surface: Option<Surface>) -> Self {
        let [ux, uy, uz, c1, c2, bx, by, bz] = values;
        Self {
            flow_m_s: Vec3::new(ux, uy, uz),
            linear_drag_n_s_per_m: c1,
            quadratic_drag_n_s2_per_m2: c2,
            bias_n: Vec3::new(bx, by, bz),
            surface,
        }
    }

    fn at_rest(rest: &RestMedium) -> Self {
        Self {
            linear_drag_n_s_per_m: rest.linear_drag.0,
            quadratic_drag_n_s2_per_m2: rest.quadratic_drag.0,
            ..Self::default()
        }
    }

    /// `part` of this medium, the rest of it at rest. The surface keeps its place and loses its
    /// stiffness: a spring is not dissipative, so it may not outlive what is known of it.
    fn faded_to(&self, rest: &RestMedium, part: f32) -> Self {
        let mut faded = Self::at_rest(rest).ramped_to(self, part);
        faded.surface = self.surface.map(|s| Surface {
            velocity_m_s: s.velocity_m_s * part,
            stiffness_n_per_m: s.stiffness_n_per_m * part,
            ..s
        });
        faded
    }

    fn ramped_to(&self, to: &Self, part: f32) -> Self {
        Self {
            flow_m_s: self.flow_m_s + (to.flow_m_s - self.flow_m_s) * part,
            linear_drag_n_s_per_m: lerp(self.linear_drag_n_s_per_m, to.linear_drag_n_s_per_m, part),
            quadratic_drag_n_s2_per_m2: lerp(
                self.quadratic_drag_n_s2_per_m2,
                to.quadratic_drag_n_s2_per_m2,
                part,
            ),
            bias_n: self.bias_n + (to.bias_n - self.bias_n) * part,
            surface: match (self.surface, to.surface) {
                (Some(a), Some(b)) => Some(a.ramped_to(&b, part)),
                (_, surface) => surface,
            },
        }
    }
}

impl Surface {
    fn ramped_to(&self, to: &Self, part: f32) -> Self {
        Self {
            height_m: lerp(self.height_m, to.height_m, part),
            velocity_m_s: lerp(self.velocity_m_s, to.velocity_m_s, part),
            stiffness_n_per_m: lerp(self.stiffness_n_per_m, to.stiffness_n_per_m, part),
            break_force_n: lerp(self.break_force_n, to.break_force_n, part),
        }
    }
}

/// Fields as they come and go: the one ramped from, the one ramped to, one that waits for its
/// time, and one that is being received.
#[derive(Clone, Debug, Default)]
pub struct Field {
    shelf: Shelf,
    ramp_start: Ticks,
    acting: bool,
    has_waiting: bool,
    freshness: f32,
}

impl Field {
    /// Begins to receive the field that `head` announces.
    ///
    /// # Errors
    /// [`Refusal::BadField`] if the device cannot hold it or the head contradicts itself.
    pub fn begin(&mut self, now: Ticks, head: FieldHead, torn: &mut u16) -> Result<(), Refusal> {
        if self.shelf.receiving().is_open() {
            count(torn);
        }
        if !(is_near(now, head.valid_until) && self.shelf.receiving().begin(head)) {
            return Err(Refusal::BadField);
        }
        if !self.shelf.receiving().is_open() {
            self.commit(now); // nothing but a head: a scene without medium
        }
        Ok(())
    }

    /// Stores a slab; with the last one the field is committed as a whole.
    pub fn store(&mut self, now: Ticks, slab: SlabHead, data: &[u8]) {
        if self.shelf.receiving().store(slab, data) {
            self.commit(now);
        }
    }

    /// What was received waits for its time. If one waits already, its time is now: a host whose
    /// clock runs ahead must not make every field give way to the next before it has acted.
    fn commit(&mut self, now: Ticks) {
        if self.has_waiting {
            self.start_ramp(now);
        }
        self.shelf.commit();
        self.has_waiting = true;
    }

    /// Prolongs the newest whole field; its ramp ends where the field itself said.
    ///
    /// # Errors
    /// [`Refusal::WrongEpoch`] if `keep` names another one, [`Refusal::BadValue`] if it would keep
    /// it for longer than a second.
    pub fn keep(&mut self, now: Ticks, keep: Keep) -> Result<(), Refusal> {
        if !is_near(now, keep.valid_until) {
            return Err(Refusal::BadValue);
        }
        let newest = if self.has_waiting { self.shelf.waiting_mut() } else { self.shelf.to_mut() };
        if newest.head.epoch != keep.epoch || keep.epoch == 0 {
            return Err(Refusal::WrongEpoch);
        }
        if keep.valid_until.since(newest.expires) > 0 {
            newest.expires = keep.valid_until;
        }
        Ok(())
    }

    /// Epoch of the field that acts, 0 before the first.
    #[must_use]
    pub fn epoch(&self) -> u32 {
        if self.acting { self.shelf.to().head.epoch } else { 0 }
    }

    /// True once a field acts.
    #[must_use]
    pub fn is_acting(&self) -> bool {
        self.acting
    }

    /// Forgets every field: a new session began.
    pub fn clear(&mut self) {
        self.acting = false;
        self.has_waiting = false;
        self.freshness = 0.0;
        self.shelf.receiving().begin(FieldHead::default());
    }

    /// Lets a waiting field act if its time has come, and how fresh the one that acts is:
    /// 1 as sent, 0 faded to rest.
    pub fn advance(&mut self, now: Ticks) -> f32 {
        if self.has_waiting
            && (!self.acting || now.since(self.shelf.waiting().head.valid_from) >= 0)
        {
            self.start_ramp(now);
        }
        if !self.acting {
            return 0.0;
        }
        let late = now.since(self.shelf.to().expires).saturating_sub(HELD_TICKS);
        let known = 1.0 - late as f32 / (FADED_TICKS - HELD_TICKS) as f32;
        let target = clamp(known, 0.0, 1.0);
        let step = clamp(target - self.freshness, -1.0, 1.0 / RECOVERY_TICKS);
        self.freshness += step;
        self.freshness
    }

    fn start_ramp(&mut self, now: Ticks) {
        self.shelf.promote();
        self.has_waiting = false;
        self.ramp_start = now;
        if !self.acting {
            self.acting = true;
            self.freshness = 1.0; // the arming ramp is gentle enough
            self.ramp_start = self.shelf.to().head.valid_until;
        }
    }

    /// The medium at `at_m`: the `wanted` channels of the two epochs, ramped, and `rest` as far
    /// as the field is stale.
    #[must_use]
    pub fn medium(&self, now: Ticks, at_m: Vec3, wanted: Channels, rest: &RestMedium) -> Medium {
        if !self.acting {
            return Medium::default(); // nothing is known of a medium
        }
        let to = self.shelf.to().medium(at_m, wanted, rest);
        let part = self.ramp(now);
        let medium = if part < 1.0 {
            self.shelf.from().medium(at_m, wanted, rest).ramped_to(&to, part)
        } else {
            to
        };
        if self.freshness < 1.0 { medium.faded_to(rest, self.freshness) } else { medium }
    }

    fn ramp(&self, now: Ticks) -> f32 {
        let length = self.shelf.to().head.valid_until.since(self.ramp_start);
        let gone = now.since(self.ramp_start);
        if length <= 0 { 1.0 } else { clamp(gone as f32 / length as f32, 0.0, 1.0) }
    }
}
