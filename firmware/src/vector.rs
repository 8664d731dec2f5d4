//! Three numbers in space. Our own, since a SIMD library sums in another order on another machine.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use cauldron_protocol::units::{Metres, MetresPerSecond, Newtons};

use crate::math;

/// A vector in device space; its unit stands in the name that holds it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3 {
    /// To the right.
    pub x: f32,
    /// Up.
    pub y: f32,
    /// Towards the user.
    pub z: f32,
}

impl Vec3 {
    /// The zero vector.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);

    /// From its components.
    #[must_use]
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self { x, y, z }
    }

    /// Scalar product.
    #[must_use]
    pub fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Length.
    #[must_use]
    pub fn norm(self) -> f32 {
        math::sqrt(self.dot(self))
    }

    /// True if no component is NaN or infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The vector, or one of the same direction and length `longest` if it is longer.
    #[must_use]
    pub fn shortened_to(self, longest: f32) -> Self {
        let norm = self.norm();
        if norm > longest { self * (longest / norm) } else { self }
    }

    /// From an array.
    #[must_use]
    pub const fn from_array([x, y, z]: [f32; 3]) -> Self {
        Self { x, y, z }
    }

    /// As an array.
    #[must_use]
    pub const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }

    /// As metres on the wire.
    #[must_use]
    pub fn metres(self) -> [Metres; 3] {
        self.to_array().map(Metres)
    }

    /// As metres per second on the wire.
    #[must_use]
    pub fn metres_per_second(self) -> [MetresPerSecond; 3] {
        self.to_array().map(MetresPerSecond)
    }

    /// As newtons on the wire.
    #[must_use]
    pub fn newtons(self) -> [Newtons; 3] {
        self.to_array().map(Newtons)
    }
}

impl From<[Metres; 3]> for Vec3 {
    fn from(metres: [Metres; 3]) -> Self {
        Self::from_array(metres.map(|m| m.0))
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl AddAssign for Vec3 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
