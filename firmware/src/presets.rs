//! Mechanisms that people know, as images.

use cauldron_protocol::{
    message::{Arm, Ceilings},
    units::{Metres, Newtons, NewtonsPerSecond, Radians},
};
use core::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use crate::settings::Image;

/// A desktop stylus like the Phantom Omni: a serial arm that reaches 0.1 m around its home,
/// 3.3 N, and a step of 0.055 mm at the handle (the last two after CHAI3D's device table).
pub const OMNI_LIKE: Image = Image {
    version: [0, 1, 0],
    arm: Arm {
        links: [Metres(0.16), Metres(0.16)],
        home: [Radians(0.0), Radians(FRAC_PI_4), Radians(-FRAC_PI_2)],
        counts_per_turn: [18_000; 3],
        reach: [
            [Radians(-1.8), Radians(1.8)],
            [Radians(-0.6), Radians(2.1)],
            [Radians(-2.9), Radians(0.1)],
        ],
    },
    ceilings: Ceilings { force: Newtons(3.3), slew: NewtonsPerSecond(800.0) },
};
