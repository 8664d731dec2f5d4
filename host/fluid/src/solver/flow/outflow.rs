//! What flows out of cells, though nothing should.

use crate::{
    pool::Partial,
    solver::flow::{
        Flow,
        engine::Engine,
        field::{FaceRuns, Lanes, Largest, Run, components, cut},
    },
};

impl Flow {
    /// Of what flows out of all liquid cells, in units of face area: the largest magnitude, the sum
    /// of squares, and the number of cells.
    pub(super) fn outflow(&self) -> [f64; 3] {
        let Self { layout, faces, pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        let velocity = components(&self.velocity);
        let body = |k: usize, _: [&mut [f32]; 0]| {
            let mut largest = Largest::default();
            let [squares, cells, ..] = on.rows(
                layout,
                k,
                #[inline(always)]
                |Run { at, len, .. }, sums| {
                    let out = FaceRuns::new(layout, velocity, at, len);
                    let liquid = cut(&faces.liquid, at, len);
                    let Some(vessel) = &faces.vessel else {
                        return tell(liquid, sums, &mut largest, |i| out.outflow(i));
                    };
                    let area = FaceRuns::new(layout, components(&vessel.area), at, len);
                    let Some(solids) = &vessel.solids else {
                        let through = |i| out.outflow_through(&area, i);
                        return tell(liquid, sums, &mut largest, through);
                    };
                    let swell = cut(&solids.swell, at, len);
                    let through = |i: usize| out.outflow_through(&area, i) + swell[i];
                    tell(liquid, sums, &mut largest, through);
                },
            );
            [largest.get(), squares, cells, 0.0]
        };
        let both = |a: Partial, b: Partial| [a[0].max(b[0]), a[1] + b[1], a[2] + b[2], 0.0];
        let [largest, squares, cells, _] = on.pool.fold(Some(layout.cells[2]), [], [], body, both);
        [largest, squares, cells]
    }
}

/// Adds the cells of a run that are liquid.
#[inline(always)]
fn tell(
    liquid: &[f32],
    [squares, cells]: &mut [Lanes; 2],
    largest: &mut Largest,
    outflow: impl Fn(usize) -> f32,
) {
    let wet = |i: usize| if liquid[i] > 0.0 { outflow(i) } else { 0.0 };
    largest.raise(liquid.len(), wet);
    squares.add(liquid.len(), |i| wet(i) * wet(i));
    cells.add(liquid.len(), |i| f32::from(u8::from(liquid[i] > 0.0)));
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::{
        grid::Grid,
        solver::{Setup, Solver, flow::Flow},
        vessel::Vessel,
    };

    /// u = x but at the far wall, where it is 0: of 8 cells in a row 7 have 1/s, the last -7/s.
    #[test]
    fn the_divergence_is_that_of_a_field_whose_divergence_is_known() {
        let mut flow = Flow::new(&Setup::new(Grid::unit_cube(8), Vessel::Box)).expect("a flow");
        flow.set_velocity(&|at: DVec3| DVec3::new(at.x, 0.0, 0.0)).expect("finite");
        assert!((flow.divergence_max_per_s() - 7.0).abs() < 1e-5);
        assert!((flow.divergence_l2_per_s() - 7f64.sqrt()).abs() < 1e-5);
    }
}
