//! What a probe that leans on the surface makes of it by its own push.
//!
//! The spring that the device renders is the whole dent: a surface that sank under the probe as
//! well would count it twice, and come back to the hand some 30 ms late, so that whatever floats
//! there swings up. Models are linear, so the part of the motion that the push makes moves by
//! itself, beside the whole of which it is a part, and what the probe feels is the rest. (So the
//! drag of a point force is told from the flow without it: Horwitz & Mani 2016.)

use super::{Load, Model, Touch};

/// The part of a probe's push in a surface, in the terms of its model; empty while there is none.
#[derive(Clone, Debug, Default)]
pub struct Own {
    state: [Vec<f32>; 2],
}

impl Own {
    pub fn bytes(&self) -> usize {
        self.state.iter().map(|values| size_of_val(values.as_slice())).sum()
    }

    /// From now on it is like all other waves.
    pub fn forget(&mut self) {
        self.state.iter_mut().for_each(Vec::clear);
    }

    /// Moves it on by `dt_s` under the push of the probe; the model's own state stays as it is.
    pub fn step(&mut self, model: &mut dyn Model, push: &Touch, dt_s: f32) {
        for (own, whole) in self.state.iter_mut().zip(model.state()) {
            own.resize(whole.len(), 0.0);
        }
        self.swap(model);
        model.step(dt_s, Load { touches: std::slice::from_ref(push), force_n: None });
        self.swap(model);
    }

    fn swap(&mut self, model: &mut dyn Model) {
        let pairs = self.state.iter_mut().zip(model.state());
        pairs.for_each(|(own, whole)| std::mem::swap(own, whole));
    }

    /// Takes it away from the model's state.
    pub fn take_from(&self, model: &mut dyn Model) {
        for (own, whole) in self.state.iter().zip(model.state()) {
            whole.iter_mut().zip(own).for_each(|(whole, own)| *whole -= own);
        }
    }
}
