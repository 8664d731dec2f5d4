//! How a step of the substances is computed: chosen from how far the flow and diffusion reach.

/// Parts that a step is cut into at most ...
pub const MAX_PARTS: f64 = 32.0;

/// ... before it is remapped, in so many parts that it costs about as much.
const REMAP_PARTS: u32 = 4;

/// Diffusion number kappa dt / h^2 up to which an explicit step has no negative weight. There
/// its error in time is no larger than that of the Laplacian in space, and of opposite sign.
const MAX_EXPLICIT_SPREAD: f64 = 1.0 / 6.0;

/// How substances were carried through a step, cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Carrying {
    /// There was nothing to carry, or it did not move.
    Nothing,
    /// In sweeps along x, y and z of fifth order in space, bounded, at most 32 of each.
    Swept,
    /// The step crossed very many cells: what lies upstream of a cell was moved there whole, axis
    /// by axis, at first order. What would overfill a cell went where there was room.
    Remapped,
}

/// How substances diffused in a step, cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Spreading {
    /// They did not.
    Nothing,
    /// Between neighbours, explicitly.
    Explicit,
    /// Along whole lines, implicitly: the step was long for the spacing.
    Implicit,
}

/// What a step of the substances did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransportReport {
    /// Parts that the step was cut into.
    pub substeps: u32,
    /// How substances were carried.
    pub carrying: Carrying,
    /// How they diffused.
    pub spreading: Spreading,
    /// Cells computed, over all parts and substances: what skipping leaves of their product.
    pub cells_computed: u64,
}

impl TransportReport {
    /// The report of a step that had nothing to do.
    #[must_use]
    pub fn nothing() -> Self {
        let (carrying, spreading) = (Carrying::Nothing, Spreading::Nothing);
        Self { substeps: 0, carrying, spreading, cells_computed: 0 }
    }
}

/// Scheme and number of parts for a step in which a cell would lose `loss` of its content.
pub fn carrying(loss: f64) -> (Carrying, u32) {
    // A courant number of exactly 1 is one part, whatever rounding made of it.
    let parts = (loss * (1.0 - 1e-6)).ceil();
    if loss <= 0.0 {
        (Carrying::Nothing, 0)
    } else if parts <= MAX_PARTS {
        (Carrying::Swept, parts.max(1.0) as u32)
    } else {
        (Carrying::Remapped, REMAP_PARTS)
    }
}

/// Scheme for a step of that diffusion number.
pub fn spreading(spread: f64) -> Spreading {
    if spread <= 0.0 {
        Spreading::Nothing
    } else if spread <= MAX_EXPLICIT_SPREAD {
        Spreading::Explicit
    } else {
        Spreading::Implicit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_cut_as_finely_as_it_needs_and_no_finer_than_can_be_paid_for() {
        assert_eq!(carrying(0.0), (Carrying::Nothing, 0));
        assert_eq!(carrying(1e-30), (Carrying::Swept, 1));
        assert_eq!(carrying(1.0 + 1e-7), (Carrying::Swept, 1));
        assert_eq!(carrying(1.1), (Carrying::Swept, 2));
        assert_eq!(carrying(32.0), (Carrying::Swept, 32));
        assert_eq!(carrying(32.1), (Carrying::Remapped, REMAP_PARTS));
        assert_eq!(carrying(1e12), (Carrying::Remapped, REMAP_PARTS));
    }

    #[test]
    fn diffusion_never_cuts_a_step() {
        let schemes = [0.0, 1e-9, 0.16, 0.17, 1e12].map(spreading);
        let [no, explicit, implicit] =
            [Spreading::Nothing, Spreading::Explicit, Spreading::Implicit];
        assert_eq!(schemes, [no, explicit, explicit, implicit, implicit]);
    }
}
