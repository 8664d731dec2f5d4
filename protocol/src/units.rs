//! SI newtypes for everything that crosses a boundary; inside a module plain `f32` carries its
//! unit in its name.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

macro_rules! unit {
    ($(#[$about:meta])* $name:ident($inner:ty)) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize, Schema)]
        pub struct $name(pub $inner);
    };
}

unit!(
    /// Length in metres.
    Metres(f32)
);
unit!(
    /// Speed in metres per second.
    MetresPerSecond(f32)
);
unit!(
    /// Force in newtons.
    Newtons(f32)
);
unit!(
    /// Slew of a force in newtons per second.
    NewtonsPerSecond(f32)
);
unit!(
    /// Stiffness in newtons per metre.
    NewtonsPerMetre(f32)
);
unit!(
    /// Linear drag in newton seconds per metre.
    NewtonSecondsPerMetre(f32)
);
unit!(
    /// Quadratic drag in newton seconds squared per square metre.
    NewtonSeconds2PerMetre2(f32)
);
unit!(
    /// Torque in newton metres.
    NewtonMetres(f32)
);
unit!(
    /// Angle in radians.
    Radians(f32)
);
unit!(
    /// Impulse in piconewton seconds: an integer, so that a sum over hours loses nothing.
    PiconewtonSeconds(i64)
);
unit!(
    /// A count of the device's servo ticks, which is its clock; wraps after 49 days at 1 kHz.
    Ticks(u32)
);

impl Ticks {
    /// Ticks from `earlier` to `self`, negative if `self` comes first; right across the wrap.
    #[must_use]
    pub fn since(self, earlier: Self) -> i32 {
        self.0.wrapping_sub(earlier.0) as i32
    }

    /// The tick `ticks` after this one.
    #[must_use]
    pub fn plus(self, ticks: u32) -> Self {
        Self(self.0.wrapping_add(ticks))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_compare_across_the_wrap() {
        assert_eq!(Ticks(3).since(Ticks(u32::MAX - 1)), 5);
        assert_eq!(Ticks(u32::MAX).since(Ticks(1)), -2);
        assert_eq!(Ticks(u32::MAX).plus(2), Ticks(1));
    }
}
