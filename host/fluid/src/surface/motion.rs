//! State and slope of a sheet, and the sums that RK4 makes of them.

/// Heights and speeds of the nodes; both in the sheet and in the four slopes of RK4.
#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    pub(super) height_m: Vec<f32>,
    pub(super) speed_m_s: Vec<f32>,
}

impl Motion {
    pub(super) fn zeros(len: usize) -> Self {
        Self { height_m: vec![0.0; len], speed_m_s: vec![0.0; len] }
    }

    /// self = base + factor * slope
    pub(super) fn set(&mut self, base: &Self, factor: f32, slope: &Self) {
        let pairs = [
            (&mut self.height_m, &base.height_m, &slope.height_m),
            (&mut self.speed_m_s, &base.speed_m_s, &slope.speed_m_s),
        ];
        for (to, from, by) in pairs {
            for ((to, from), by) in to.iter_mut().zip(from).zip(by) {
                *to = from + factor * by;
            }
        }
    }

    /// self += factor * slope
    pub(super) fn add(&mut self, factor: f32, slope: &Self) {
        let pairs =
            [(&mut self.height_m, &slope.height_m), (&mut self.speed_m_s, &slope.speed_m_s)];
        for (to, by) in pairs {
            for (to, by) in to.iter_mut().zip(by) {
                *to += factor * by;
            }
        }
    }
}
