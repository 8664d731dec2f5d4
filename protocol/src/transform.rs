//! Where the hand's space lies in the world: one uniform scale and an offset, so that a sphere
//! felt is a sphere seen.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Maps device metres to world metres: `world = scale * device + offset`, both y up.
///
/// One scale for all axes: an axis by axis map (Mora 2008) turns isotropic drag into an
/// anisotropic one, so it is left to pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct WorldFromDevice {
    /// World metres in a device metre; above zero.
    pub scale: f32,
    /// World position of the device's origin in metres.
    pub offset_m: [f32; 3],
}

impl Default for WorldFromDevice {
    fn default() -> Self {
        Self { scale: 1.0, offset_m: [0.0; 3] }
    }
}

impl WorldFromDevice {
    /// The map that puts a box of the workspace into a box of the world, centre on centre, as
    /// large as one uniform scale allows. Each box is given by its lower and upper corner.
    ///
    /// The printed map of Mora 2008, (P + max) / (max - min), is right only for ranges that are
    /// symmetric about zero; this one takes any. `None` where a box is empty or not finite.
    #[must_use]
    pub fn from_boxes(device: [[f32; 3]; 2], world: [[f32; 3]; 2]) -> Option<Self> {
        let mut scale = f32::MAX;
        for ((d0, d1), (w0, w1)) in corners(device).zip(corners(world)) {
            let ratio = (w1 - w0) / (d1 - d0);
            let sound = d1 - d0 > 0.0 && ratio > 0.0 && ratio < f32::MAX;
            if !sound {
                return None;
            }
            if ratio < scale {
                scale = ratio;
            }
        }
        let mut offset_m = [0.0; 3];
        for (offset, ((d0, d1), (w0, w1))) in
            offset_m.iter_mut().zip(corners(device).zip(corners(world)))
        {
            *offset = 0.5 * (w0 + w1) - scale * 0.5 * (d0 + d1);
        }
        Some(Self { scale, offset_m })
    }

    /// A device position in world metres.
    #[must_use]
    pub fn point(&self, device_m: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = device_m;
        let [ox, oy, oz] = self.offset_m;
        [self.scale * x + ox, self.scale * y + oy, self.scale * z + oz]
    }

    /// A world position in device metres.
    #[must_use]
    pub fn point_in_device(&self, world_m: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = world_m;
        let [ox, oy, oz] = self.offset_m;
        [(x - ox) / self.scale, (y - oy) / self.scale, (z - oz) / self.scale]
    }

    /// True if the map can be used: finite, and its scale within 1/1000 to 1000.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.scale >= 1e-3 && self.scale <= 1e3 && self.offset_m.iter().all(|v| v.is_finite())
    }
}

fn corners(ends: [[f32; 3]; 2]) -> impl Iterator<Item = (f32, f32)> {
    let [lower, upper] = ends;
    lower.into_iter().zip(upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_asymmetric_workspace_lands_inside_the_box_with_one_scale() {
        let device = [[-0.05, 0.02, -0.10], [0.15, 0.10, 0.00]];
        let world = [[-0.2, -0.2, -0.2], [0.2, 0.0, 0.2]];
        let map = WorldFromDevice::from_boxes(device, world).unwrap();
        assert!((map.scale - 2.0).abs() < 1e-6);
        for (corner, inside) in [(device[0], [-0.2, -0.18, -0.1]), (device[1], [0.2, -0.02, 0.1])] {
            for (got, want) in map.point(corner).into_iter().zip(inside) {
                assert!((got - want).abs() < 1e-6, "{got} {want}");
            }
        }
    }

    #[test]
    fn there_and_back() {
        let map = WorldFromDevice { scale: 1.7, offset_m: [0.1, -0.2, 0.3] };
        let p = [0.01, 0.02, -0.03];
        for (a, b) in map.point_in_device(map.point(p)).into_iter().zip(p) {
            assert!((a - b).abs() < 1e-7);
        }
    }

    #[test]
    fn an_empty_or_broken_box_is_refused() {
        let unit = [[0.0; 3], [1.0; 3]];
        assert_eq!(WorldFromDevice::from_boxes([[0.0; 3], [1.0, 0.0, 1.0]], unit), None);
        assert_eq!(WorldFromDevice::from_boxes(unit, [[0.0; 3], [f32::NAN, 1.0, 1.0]]), None);
        assert!(!WorldFromDevice { scale: f32::NAN, offset_m: [0.0; 3] }.is_sound());
    }
}
