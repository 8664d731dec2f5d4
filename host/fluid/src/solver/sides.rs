//! What happens at the six sides of the grid's box.

use glam::Vec3;

use super::{Refused, SetupError, Walls, within};

/// Fastest that a side may move or let in.
const MAX_SIDE_SPEED_M_S: f64 = 1e3;

/// What a flow meets at one side of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// A wall that it slides along.
    FreeSlip,
    /// A wall that it sticks to.
    NoSlip,
    /// A wall that it sticks to and that moves within its own plane at this velocity in m/s;
    /// what would move it out of its plane is left out.
    Moving(Vec3),
    /// An opening through which it comes (or is drawn off) at this velocity in m/s.
    Inflow(Vec3),
    /// An opening through which it leaves as it likes, and beyond which all is at rest: what comes
    /// back in brings no energy, nor any velocity along the side.
    Outflow,
    /// No side at all: what leaves here enters at the opposite side, which is periodic too.
    Periodic,
}

impl Side {
    /// The side made of what a vessel's wall is made of.
    #[must_use]
    pub fn of(walls: Walls) -> Self {
        match walls {
            Walls::FreeSlip => Self::FreeSlip,
            Walls::NoSlip => Self::NoSlip,
        }
    }

    /// The velocity that it imposes, if it sticks to the flow: zero for a resting wall.
    #[must_use]
    pub fn velocity_m_s(&self, axis: usize) -> Option<Vec3> {
        match *self {
            Self::FreeSlip | Self::Outflow | Self::Periodic => None,
            Self::NoSlip => Some(Vec3::ZERO),
            Self::Moving(mut velocity) => {
                velocity[axis] = 0.0;
                Some(velocity)
            }
            Self::Inflow(velocity) => Some(velocity),
        }
    }

    /// True if it can put energy into the flow.
    #[must_use]
    pub fn drives(&self) -> bool {
        matches!(self, Self::Moving(_) | Self::Inflow(_))
    }
}

/// The six sides: along x, y and z, the lower one first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides(pub [[Side; 2]; 3]);

impl Sides {
    /// The same on all six.
    #[must_use]
    pub fn all(side: Side) -> Self {
        Self([[side; 2]; 3])
    }

    /// A box with these walls, and a lid on top that the liquid slides along: its resting
    /// surface.
    #[must_use]
    pub fn of_vessel(walls: Walls) -> Self {
        let mut sides = Self::all(Side::of(walls));
        sides.0[1][1] = Side::FreeSlip;
        sides
    }

    /// These, but for both sides of one axis.
    #[must_use]
    pub fn with(mut self, axis: usize, both: [Side; 2]) -> Self {
        self.0[axis] = both;
        self
    }

    /// True if the axis is periodic.
    #[must_use]
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.0[axis] == [Side::Periodic; 2]
    }

    /// Largest |u| + |v| + |w| that a side imposes.
    #[must_use]
    pub fn largest_speed_m_s(&self) -> f64 {
        let speed = |(axis, side): (usize, &Side)| {
            side.velocity_m_s(axis).map_or(0.0, |u| f64::from(u.abs().element_sum()))
        };
        let both = |(axis, both): (usize, &[Side; 2])| both.map(|side| speed((axis, &side)));
        self.0.iter().enumerate().flat_map(both).fold(0.0, f64::max)
    }

    /// True if some side can put energy into the flow.
    #[must_use]
    pub fn drive(&self) -> bool {
        self.0.iter().flatten().any(Side::drives)
    }

    /// Checks that the sides make sense together, for a box whose sides along each axis have
    /// this many faces.
    ///
    /// # Errors
    /// If a velocity is not finite or above 1000 m/s, only one side of an axis is periodic, or
    /// more comes in than goes out with no outflow to make up for it.
    pub fn check(&self, faces: [usize; 3]) -> Result<(), SetupError> {
        let (mut net_m_s, mut largest_m_s, mut has_outflow) = (0.0, 0f64, false);
        for (axis, both) in self.0.iter().enumerate() {
            for (sign, side) in [1.0, -1.0].into_iter().zip(both) {
                if let Side::Moving(velocity) | Side::Inflow(velocity) = side {
                    for value in velocity.to_array() {
                        within("velocity of a side in m/s", f64::from(value), MAX_SIDE_SPEED_M_S)?;
                    }
                }
                if let Side::Inflow(velocity) = side {
                    let passing_m_s = faces[axis] as f64 * f64::from(velocity[axis]);
                    net_m_s += sign * passing_m_s;
                    largest_m_s = largest_m_s.max(passing_m_s.abs());
                }
                has_outflow |= *side == Side::Outflow;
            }
            if both.contains(&Side::Periodic) && !self.is_periodic(axis) {
                return Err(SetupError::Unsupported(
                    "only one side of an axis is periodic: make both so",
                ));
            }
        }
        if !has_outflow && net_m_s.abs() > 1e-5 * largest_m_s {
            let refused = Refused { what: "net inflow without an outflow", value: net_m_s };
            return Err(refused.into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACES: [usize; 3] = [64, 64, 64];

    #[test]
    fn sides_that_cannot_be_are_refused_with_the_reason() {
        let free = Sides::all(Side::FreeSlip);
        assert_eq!(free.check(FACES), Ok(()));
        let half = free.with(0, [Side::Periodic, Side::FreeSlip]).check(FACES);
        assert!(half.expect_err("half periodic").to_string().contains("periodic"));
        let jet = Side::Inflow(Vec3::X);
        let blocked = free.with(0, [jet, Side::NoSlip]).check(FACES);
        assert!(blocked.expect_err("nowhere to go").to_string().contains("64"));
        assert_eq!(free.with(0, [jet, Side::Outflow]).check(FACES), Ok(()));
        assert_eq!(free.with(0, [jet, jet]).check(FACES), Ok(()), "in here, out there");
        let mad = free.with(1, [Side::Moving(Vec3::new(f32::NAN, 0.0, 0.0)), Side::NoSlip]);
        assert!(mad.check(FACES).expect_err("NaN").to_string().contains("NaN"));
    }

    #[test]
    fn a_moving_wall_stays_in_its_plane() {
        let lid = Side::Moving(Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(lid.velocity_m_s(1), Some(Vec3::new(1.0, 0.0, 3.0)));
        assert_eq!(Side::Outflow.velocity_m_s(0), None);
        assert!(lid.drives() && !Side::Outflow.drives());
    }
}
