//! The force that is wanted: the sum of the modes that are on. One file each; what is off is not
//! computed.

mod buoyancy;
mod flow;
mod surface;
mod viscosity;
mod walls;

pub use surface::{Contact, DAMPING_S, SurfaceContact};

use cauldron_protocol::{
    Vessel,
    field::{Channel, Channels},
    message::{Modes, Params},
};

use crate::{field::Medium, vector::Vec3};

/// The force wanted in a tick, and by whom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// By liquid and surface: what is given to the hand is taken from them.
    pub medium_n: Vec3,
    /// By what no medium carries: weight and buoyancy, which move no liquid. They act wherever the
    /// field says, in the air too.
    pub bias_n: Vec3,
    /// By the walls, which nothing moves.
    pub walls_n: Vec3,
    /// Where the walls let the handle be.
    pub proxy_m: Vec3,
    /// How the probe stands to the medium.
    pub contact: Contact,
}

impl Wanted {
    /// All of it.
    #[must_use]
    pub fn total_n(&self) -> Vec3 {
        self.medium_n + self.bias_n + self.walls_n
    }

    /// True if a wall is touched.
    #[must_use]
    pub fn on_wall(&self) -> bool {
        self.walls_n != Vec3::ZERO
    }
}

/// The channels that the modes need; others are not sampled.
#[must_use]
pub fn channels_for(modes: Modes) -> Channels {
    let drag = if modes.viscosity || modes.flow { Channel::DRAG } else { Channels::default() };
    let flow = if modes.flow { Channel::FLOW } else { Channels::default() };
    drag.and(flow).and(Channel::BIAS)
}

/// The force modes and what they remember from tick to tick.
#[derive(Clone, Debug, Default)]
pub struct Servo {
    surface: SurfaceContact,
}

impl Servo {
    /// The force wanted at a position in metres and a velocity in m/s.
    pub fn force(
        &mut self,
        params: &Params,
        position_m: Vec3,
        velocity_m_s: Vec3,
        medium: &Medium,
        vessel: &Vessel,
    ) -> Wanted {
        let (modes, pull_n) = (params.modes, params.pull_force.0);
        let (surface, felt) = (&mut self.surface, modes.surface);
        let contact = surface.update(felt, pull_n, position_m, velocity_m_s, medium);
        let mut wanted =
            Wanted { bias_n: medium.bias_n, proxy_m: position_m, contact, ..Wanted::default() };
        if modes.surface {
            wanted.medium_n += surface::force_n(contact, pull_n, position_m, velocity_m_s, medium);
        }
        wanted.medium_n += buoyancy::damping_n(params.buoyancy, position_m, velocity_m_s, medium);
        if contact == Contact::Wet {
            wanted.medium_n += in_medium_n(modes, velocity_m_s, medium);
        }
        if modes.walls {
            let wall = walls::contact(vessel, position_m, velocity_m_s);
            wanted.walls_n = wall.force_n;
            wanted.proxy_m = wall.proxy_m;
        }
        wanted
    }
}

/// F = (c1 + c2 |w|) w with w = flow - velocity, of which each mode has its term.
fn in_medium_n(modes: Modes, velocity_m_s: Vec3, medium: &Medium) -> Vec3 {
    let mut force_n = Vec3::ZERO;
    if modes.viscosity || modes.flow {
        let flow = if modes.flow { medium.flow_m_s } else { Vec3::ZERO };
        let relative_m_s = (flow - velocity_m_s).norm();
        let drag_n_s_per_m =
            medium.linear_drag_n_s_per_m + medium.quadratic_drag_n_s2_per_m2 * relative_m_s;
        if modes.viscosity {
            force_n += viscosity::force_n(drag_n_s_per_m, velocity_m_s);
        }
        if modes.flow {
            force_n += flow::force_n(drag_n_s_per_m, flow);
        }
    }
    force_n
}

#[cfg(test)]
mod tests {
    use super::*;
    use cauldron_protocol::{
        message::{Buoyancy, RestMedium},
        units::Newtons,
    };

    const ALL: Modes = Modes { surface: true, viscosity: true, flow: true, walls: true };

    fn water() -> Medium {
        Medium {
            flow_m_s: Vec3::new(0.1, 0.0, 0.0),
            linear_drag_n_s_per_m: 2.0,
            quadratic_drag_n_s2_per_m2: 10.0,
            ..Medium::default()
        }
    }

    fn force(modes: Modes, velocity: Vec3) -> Vec3 {
        let vessel = Vessel::default();
        Servo::default().force(&params(modes), Vec3::ZERO, velocity, &water(), &vessel).total_n()
    }

    fn params(modes: Modes) -> Params {
        let (rest, buoyancy) = (RestMedium::default(), Buoyancy::default());
        Params { modes, rest, pull_force: Newtons(0.0), buoyancy }
    }

    #[test]
    fn what_no_medium_carries_acts_in_the_air_too_and_moves_no_liquid() {
        let down = Vec3::new(0.0, -0.3, 0.0);
        let air = Medium { bias_n: down, ..Medium::default() };
        let still = Vec3::ZERO;
        let wanted = Servo::default().force(&params(ALL), still, still, &air, &Vessel::default());
        assert_eq!((wanted.contact, wanted.total_n()), (Contact::Dry, down));
        assert_eq!(wanted.medium_n, Vec3::ZERO);
    }

    #[test]
    fn the_law_of_the_medium() {
        let v = Vec3::new(-0.2, 0.0, 0.0);
        let w = 0.3;
        assert!((force(ALL, v).x - (2.0 + 10.0 * w) * w).abs() < 1e-6);
    }

    #[test]
    fn a_handle_that_drifts_with_the_current_feels_nothing() {
        assert_eq!(force(ALL, Vec3::new(0.1, 0.0, 0.0)), Vec3::ZERO);
    }

    #[test]
    fn each_mode_can_be_switched_alone() {
        let v = Vec3::new(0.0, 0.3, 0.0);
        let viscosity = force(Modes { viscosity: true, ..Modes::default() }, v);
        assert!(viscosity.x == 0.0 && (viscosity.y + (2.0 + 3.0) * 0.3).abs() < 1e-6);
        let flow = force(Modes { flow: true, ..Modes::default() }, Vec3::ZERO);
        assert!((flow.x - (2.0 + 1.0) * 0.1).abs() < 1e-6 && flow.y == 0.0);
        assert_eq!(force(Modes::default(), v), Vec3::ZERO);
    }

    #[test]
    fn modes_ask_for_no_channel_they_do_not_need() {
        assert_eq!(channels_for(Modes::default()), Channel::BIAS);
        assert!(
            !channels_for(Modes { viscosity: true, ..Modes::default() }).contains(Channel::FLOW)
        );
        assert!(channels_for(ALL).contains(Channel::FLOW.and(Channel::DRAG)));
    }
}
